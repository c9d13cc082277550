#include "server/documents/tile_matrix_set.h"

#include <algorithm>
#include <cmath>

#include "core/grid/web_mercator.h"
#include "render/mask/mask.h"

namespace trapeze {

double cell_size(int zoom) {
  return 2 * kMercatorHalfSide / kTilePixels / std::exp2(zoom);
}

double scale_denominator(int zoom) {
  constexpr double kMetresPerPixel = 0.00028;
  return cell_size(zoom) / kMetresPerPixel;
}

TileLimits tile_limits(const Box& box, int zoom) {
  const std::int64_t side = kGridSize >> zoom;
  const auto tile_of = [&](std::int64_t cell) {
    const std::int64_t last = (std::int64_t{1} << zoom) - 1;
    return static_cast<std::uint32_t>(std::min((cell - kGridMin) / side, last));
  };
  return {tile_of(box.min_y), tile_of(box.max_y), tile_of(box.min_x), tile_of(box.max_x)};
}

}  // namespace trapeze
