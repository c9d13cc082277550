#include "render/coverage.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace trapeze {
namespace {

constexpr std::int64_t kMaxOrigin = std::int64_t{1} << 40;

std::int32_t clamp_to_grid(double cells) {
  return static_cast<std::int32_t>(
      std::clamp(cells, static_cast<double>(kGridMin), static_cast<double>(kGridMax)));
}

bool is_off_grid(double from, double to) {
  return to < kGridMin || from > kGridMax;
}

}  // namespace

View View::of_tile(const TileId& tile, int scale) {
  View view;
  view.origin_x = tile.origin_x();
  view.origin_y = tile.origin_y();
  view.width = view.height = kTilePixels * scale;
  view.cells_per_pixel = static_cast<double>(tile.side()) / view.width;
  return view;
}

Box View::box() const {
  const double min_x = static_cast<double>(origin_x);
  const double min_y = static_cast<double>(origin_y);
  const double max_x = min_x + std::ceil(width * cells_per_pixel);
  const double max_y = min_y + std::ceil(height * cells_per_pixel);
  if (is_off_grid(min_x, max_x) || is_off_grid(min_y, max_y)) return Box{};
  return Box{clamp_to_grid(min_x), clamp_to_grid(min_y), clamp_to_grid(max_x),
             clamp_to_grid(max_y)};
}

void View::check() const {
  if (width < 1 || height < 1 || width > kMaxPicturePixels || height > kMaxPicturePixels) {
    throw std::invalid_argument("a picture is 1 to " + std::to_string(kMaxPicturePixels) +
                                " pixels wide and high, not " + std::to_string(width) + " x " +
                                std::to_string(height));
  }
  if (!(cells_per_pixel > 0) || !std::isfinite(cells_per_pixel)) {
    throw std::invalid_argument("cells_per_pixel must be positive and finite");
  }
  if (std::max(std::abs(origin_x), std::abs(origin_y)) > kMaxOrigin) {
    throw std::invalid_argument("the view lies too far off the world");
  }
}

void Coverage::resize(int width, int height) {
  width_ = width;
  height_ = height;
  pixels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

bool Coverage::is_all(std::uint8_t level) const {
  return std::all_of(pixels_.begin(), pixels_.end(),
                     [level](std::uint8_t p) { return p == level; });
}

// Written so that compilers turn it into vector instructions: it is run on every pixel.
void to_levels(std::span<const float> sums, std::uint8_t* levels) {
  for (std::size_t i = 0; i < sums.size(); ++i) {
    float share = sums[i] > 0.0f ? sums[i] : 0.0f;
    share = share < 1.0f ? share : 1.0f;
    levels[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>(share * 255.0f + 0.5f));
  }
}

}  // namespace trapeze
