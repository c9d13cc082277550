#include "render/mask/mask.h"

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
  const auto min_x = static_cast<double>(origin_x);
  const auto min_y = static_cast<double>(origin_y);
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

void Mask::resize(int width, int height) {
  width_ = width;
  height_ = height;
  pixels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

void Mask::fill(std::uint8_t value) {
  std::fill(pixels_.begin(), pixels_.end(), value);
}

bool Mask::is_all(std::uint8_t value) const {
  return std::all_of(pixels_.begin(), pixels_.end(),
                     [value](std::uint8_t p) { return p == value; });
}

namespace {

// Four pixels at once, by the vector extensions of g++ and clang.
template <class Element>
struct Four {
  using Type __attribute__((vector_size(4 * sizeof(Element)))) = Element;
};
template <class Element>
using FourOf = typename Four<Element>::Type;

constexpr std::size_t kBlock = 8;  // pixels that are looked at together

// Sums of the first 1, 2, 3, 4 elements.
template <class Element>
FourOf<Element> sums_of(FourOf<Element> differences) {
  const FourOf<Element> none{};
  const FourOf<Element> pairs =
      differences + __builtin_shufflevector(none, differences, 0, 4, 5, 6);
  return pairs + __builtin_shufflevector(none, pairs, 0, 1, 4, 5);
}

void put_values(FourOf<float> shares_of_255, std::uint8_t* values) {
  const FourOf<float> none{};
  const FourOf<float> all = none + 255.0f;
  shares_of_255 = shares_of_255 < none ? none : shares_of_255;
  shares_of_255 = shares_of_255 > all ? all : shares_of_255;
  const auto rounded = __builtin_convertvector(shares_of_255 + 0.5f, FourOf<std::int32_t>);
  const auto bytes = __builtin_convertvector(rounded, FourOf<std::uint8_t>);
  std::memcpy(values, &bytes, sizeof bytes);
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

// Differences are 0 except at the boundaries of polygons: blocks of zeros repeat the last value.
template <class Element>
void resolve_row_by(Element whole, std::span<Element> differences, std::uint8_t* values) {
  const float values_per_unit = 255.0f / static_cast<float>(whole);
  FourOf<Element> before{};
  std::uint8_t value_before = 0;
  const auto take_four = [&](Element* from, std::uint8_t* to) {
    FourOf<Element> sums;
    std::memcpy(&sums, from, sizeof sums);
    sums = before + sums_of<Element>(sums);
    before = __builtin_shufflevector(sums, sums, 3, 3, 3, 3);
    put_values(__builtin_convertvector(sums, FourOf<float>) * values_per_unit, to);
    std::memset(from, 0, sizeof sums);
  };
  std::size_t i = 0;
  for (; i + kBlock <= differences.size(); i += kBlock) {
    Element* begin = differences.data() + i;
    if (is_all_zero(begin)) {
      std::memset(values + i, value_before, kBlock);
      continue;
    }
    take_four(begin, values + i);
    take_four(begin + 4, values + i + 4);
    value_before = values[i + kBlock - 1];
  }
  for (; i < differences.size(); i += 4) {
    const std::size_t count = std::min<std::size_t>(4, differences.size() - i);
    std::array<Element, 4> rest{};
    std::array<std::uint8_t, 4> values_of_rest;
    std::copy_n(differences.data() + i, count, rest.data());
    take_four(rest.data(), values_of_rest.data());
    std::copy_n(values_of_rest.data(), count, values + i);
    std::fill_n(differences.data() + i, count, Element{0});
  }
}

}  // namespace

void resolve_row(std::span<float> differences, std::uint8_t* values) {
  resolve_row_by(1.0f, differences, values);
}

void resolve_row(std::span<std::int32_t> differences, std::int32_t whole, std::uint8_t* values) {
  resolve_row_by(whole, differences, values);
}

}  // namespace trapeze
