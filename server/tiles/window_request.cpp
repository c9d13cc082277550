#include "server/tiles/window_request.h"

#include <spdlog/fmt/fmt.h>

#include <utility>

namespace trapeze {

WindowRequest window_of(TileRequest tile) {
  std::string caption = fmt::format("{}/{}/{}", tile.tile.z, tile.tile.x, tile.tile.y);
  if (tile.scale > 1) caption += fmt::format(" {}x", tile.scale);
  return {std::move(tile.layers),
          View::of_tile(tile.tile, tile.scale),
          static_cast<double>(tile.scale),
          std::move(tile.style),
          tile.format,
          std::move(caption)};
}

}  // namespace trapeze
