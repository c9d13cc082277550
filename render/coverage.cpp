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

template <class Element>
using Block = std::array<Element, kBlock>;

// A coverage of 1 is `whole`.
template <class Element>
struct ToLevel {
  Element whole;
  float levels = 255.0f / static_cast<float>(whole);

  std::uint8_t operator()(Element sum) const {
    const auto within = static_cast<float>(std::min(std::max(sum, Element{0}), whole));
    return static_cast<std::uint8_t>(static_cast<std::int32_t>(within * levels + 0.5f));
  }
};

// Sums of the first 1, 2, ... 8 elements, by a tree: one after the other each would wait for the
// one before.
template <class Element>
Block<Element> sums_of(const Block<Element>& d) {
  const Element to_1 = d[0] + d[1];
  const Element to_3 = to_1 + (d[2] + d[3]);
  const Element from_4_to_5 = d[4] + d[5];
  return {d[0],
          to_1,
          to_1 + d[2],
          to_3,
          to_3 + d[4],
          to_3 + from_4_to_5,
          to_3 + (from_4_to_5 + d[6]),
          to_3 + (from_4_to_5 + (d[6] + d[7]))};
}

template <class Element>
bool is_all_zero(const Element* differences) {
  const auto pair = [differences](std::size_t i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, differences + 2 * i, sizeof bits);
    return bits;
  };
  return (pair(0) | pair(1) | pair(2) | pair(3)) == 0;
}

// Between the boundaries of polygons nothing changes.
template <class Element>
void take_levels_by(const ToLevel<Element>& to_level, std::span<Element> differences,
                    std::uint8_t* levels) {
  Element before = 0;
  std::uint8_t level_before = 0;
  std::size_t i = 0;
  for (; i + kBlock <= differences.size(); i += kBlock) {
    Element* begin = differences.data() + i;
    if (is_all_zero(begin)) {
      std::memset(levels + i, level_before, kBlock);
      continue;
    }
    Block<Element> sums;
    std::copy_n(begin, kBlock, sums.begin());
    sums = sums_of(sums);
    for (std::size_t k = 0; k < kBlock; ++k) levels[i + k] = to_level(before + sums[k]);
    before += sums.back();
    level_before = levels[i + kBlock - 1];
    std::fill_n(begin, kBlock, Element{0});
  }
  for (; i < differences.size(); ++i) {
    levels[i] = to_level(before += differences[i]);
    differences[i] = 0;
  }
}

}  // namespace

void take_levels(std::span<float> differences, std::uint8_t* levels) {
  take_levels_by(ToLevel<float>{1}, differences, levels);
}

void take_levels(std::span<std::int32_t> differences, std::int32_t whole, std::uint8_t* levels) {
  take_levels_by(ToLevel<std::int32_t>{whole}, differences, levels);
}

}  // namespace trapeze
