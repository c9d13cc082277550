#include "server/tiles/window_request.h"

#include <spdlog/fmt/fmt.h>

#include <utility>

namespace trapeze {

WindowRequest window_of(TileRequest tile) {
  const bool is_usual = tile.set == web_mercator_quad();
  std::string caption = fmt::format("{}/{}/{}", tile.tile.z, tile.tile.x, tile.tile.y);
  if (!is_usual) caption = fmt::format("{}/{}", tile.set->id, caption);
  if (tile.scale > 1) caption += fmt::format(" {}x", tile.scale);
  return {
      std::move(tile.layers),
      is_usual ? View::of_tile(tile.tile, tile.scale) : tile.set->view_of(tile.tile, tile.scale),
      static_cast<double>(tile.scale),
      std::move(tile.style),
      tile.format,
      std::move(caption),
      tile.set->system};
}

}  // namespace trapeze
