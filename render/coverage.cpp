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

constexpr std::size_t kBlock = 8;  // pixels that are looked at together

struct FloatLevel {
  std::uint8_t operator()(float sum) const {
    const float share = std::min(std::max(sum, 0.0f), 1.0f);
    return static_cast<std::uint8_t>(static_cast<std::int32_t>(share * 255.0f + 0.5f));
  }
};

struct IntegerLevel {
  std::int32_t whole;
  float levels_per_unit = 255.0f / static_cast<float>(whole);

  std::uint8_t operator()(std::int32_t sum) const {
    const auto part = static_cast<float>(std::min(std::max(sum, 0), whole));
    return static_cast<std::uint8_t>(static_cast<std::int32_t>(part * levels_per_unit + 0.5f));
  }
};

// Sums of the first 1, 2, ... 8 elements, by a tree: one after the other each would wait for the
// one before.
template <class Element>
void sum_up(const Element* d, std::array<Element, kBlock>& sums) {
  const Element to_1 = d[0] + d[1];
  const Element to_3 = to_1 + (d[2] + d[3]);
  const Element from_4_to_5 = d[4] + d[5];
  sums = {d[0],
          to_1,
          to_1 + d[2],
          to_3,
          to_3 + d[4],
          to_3 + from_4_to_5,
          to_3 + (from_4_to_5 + d[6]),
          to_3 + (from_4_to_5 + (d[6] + d[7]))};
}

// Between the boundaries of polygons nothing changes.
template <class Element>
bool is_all_zero(const Element* differences) {
  std::array<std::uint64_t, kBlock / 2> pairs;
  static_assert(sizeof pairs == kBlock * sizeof(Element));
  std::memcpy(pairs.data(), differences, sizeof pairs);
  return (pairs[0] | pairs[1] | pairs[2] | pairs[3]) == 0;
}

template <class Element, class ToLevel>
void sum_to_levels_by(const ToLevel& to_level, std::span<const Element> differences,
                      std::uint8_t* levels) {
  Element before = 0;
  std::size_t i = 0;
  std::array<Element, kBlock> sums;
  for (; i + kBlock <= differences.size(); i += kBlock) {
    if (is_all_zero(differences.data() + i)) {
      std::memset(levels + i, to_level(before), kBlock);
      continue;
    }
    sum_up(differences.data() + i, sums);
    for (std::size_t k = 0; k < kBlock; ++k) levels[i + k] = to_level(before + sums[k]);
    before += sums.back();
  }
  for (; i < differences.size(); ++i) levels[i] = to_level(before += differences[i]);
}

}  // namespace

void sum_to_levels(std::span<const float> differences, std::uint8_t* levels) {
  sum_to_levels_by(FloatLevel{}, differences, levels);
}

void sum_to_levels(std::span<const std::int32_t> differences, std::int32_t whole,
                   std::uint8_t* levels) {
  sum_to_levels_by(IntegerLevel{whole}, differences, levels);
}

}  // namespace trapeze
