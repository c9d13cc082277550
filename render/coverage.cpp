#include "render/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
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

void Coverage::fill(std::uint8_t level) {
  std::fill(pixels_.begin(), pixels_.end(), level);
}

bool Coverage::is_all(std::uint8_t level) const {
  return std::all_of(pixels_.begin(), pixels_.end(),
                     [level](std::uint8_t p) { return p == level; });
}

namespace {

std::uint8_t to_level(float sum) {
  const float share = std::min(std::max(sum, 0.0f), 1.0f);
  return static_cast<std::uint8_t>(static_cast<std::int32_t>(share * 255.0f + 0.5f));
}

}  // namespace

// Looks at eight pixels at once: between the boundaries of polygons nothing changes.
void sum_to_levels(std::span<const float> differences, std::uint8_t* levels) {
  constexpr std::size_t kBlock = 8;
  float sum = 0;
  std::size_t i = 0;
  for (; i + kBlock <= differences.size(); i += kBlock) {
    std::array<std::uint64_t, kBlock / 2> pairs;
    std::memcpy(pairs.data(), differences.data() + i, sizeof pairs);
    if ((pairs[0] | pairs[1] | pairs[2] | pairs[3]) == 0) {
      std::memset(levels + i, to_level(sum), kBlock);
      continue;
    }
    for (std::size_t k = i; k < i + kBlock; ++k) levels[k] = to_level(sum += differences[k]);
  }
  for (; i < differences.size(); ++i) levels[i] = to_level(sum += differences[i]);
}

}  // namespace trapeze
