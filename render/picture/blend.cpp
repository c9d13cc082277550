#include "render/picture/blend.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace trapeze {

void blend(Picture& picture, int column, int row, Rgba colour, double share) {
  if (column < 0 || row < 0 || column >= picture.width || row >= picture.height) return;
  Rgba& below =
      picture.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(picture.width) +
                     static_cast<std::size_t>(column)];
  const double over = colour.a / 255.0 * share;
  const double under = below.a / 255.0 * (1 - over);
  const double alpha = over + under;
  if (alpha <= 0) return;
  const auto mix = [&](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround((a * over + b * under) / alpha));
  };
  below = {mix(colour.r, below.r), mix(colour.g, below.g), mix(colour.b, below.b),
           static_cast<std::uint8_t>(std::lround(alpha * 255))};
}

}  // namespace trapeze
