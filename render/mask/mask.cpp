#include "render/mask/mask.h"

#include <algorithm>
#include <array>
#include <bit>
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

/// Goes along a row of differences, and sets them to 0.
template <class Element>
class RowSum {
 public:
  explicit RowSum(Element whole) : values_per_unit_(255.0f / static_cast<float>(whole)) {}

  /// Takes so many of them.
  void take(Element* differences, std::size_t count, std::uint8_t* values) {
    std::size_t i = 0;
    for (; i + 4 <= count; i += 4) take_four(differences + i, values + i);
    if (i < count) take_rest(differences + i, count - i, values + i);
    if (count > 0) last_ = values[count - 1];
  }
  /// Takes so many that are all 0.
  void pass(std::size_t count, std::uint8_t* values) const { std::memset(values, last_, count); }

 private:
  void take_four(Element* from, std::uint8_t* to) {
    FourOf<Element> sums;
    std::memcpy(&sums, from, sizeof sums);
    sums = before_ + sums_of<Element>(sums);
    before_ = __builtin_shufflevector(sums, sums, 3, 3, 3, 3);
    put_values(__builtin_convertvector(sums, FourOf<float>) * values_per_unit_, to);
    std::memset(from, 0, sizeof sums);
  }
  void take_rest(Element* from, std::size_t count, std::uint8_t* to) {
    std::array<Element, 4> rest{};
    std::array<std::uint8_t, 4> values;
    std::copy_n(from, count, rest.data());
    take_four(rest.data(), values.data());
    std::copy_n(values.data(), count, to);
    std::fill_n(from, count, Element{0});
  }

  float values_per_unit_;
  FourOf<Element> before_{};
  std::uint8_t last_ = 0;
};

// Differences are 0 except at the boundaries of polygons: blocks of zeros repeat the last value.
template <class Element>
void resolve_row_by(Element whole, std::span<Element> differences, std::uint8_t* values) {
  RowSum<Element> sum(whole);
  std::size_t i = 0;
  for (; i + kBlock <= differences.size(); i += kBlock) {
    Element* begin = differences.data() + i;
    if (is_all_zero(begin)) {
      sum.pass(kBlock, values + i);
    } else {
      sum.take(begin, kBlock, values + i);
    }
  }
  sum.take(differences.data() + i, differences.size() - i, values + i);
}

}  // namespace

void resolve_row(std::span<float> differences, std::uint8_t* values) {
  resolve_row_by(1.0f, differences, values);
}

void resolve_row(std::span<float> differences, std::uint64_t touched, unsigned shift,
                 std::uint8_t* values) {
  RowSum<float> sum(1.0f);
  std::size_t i = 0;
  const auto column_of = [&](int bit) {
    return std::min(static_cast<std::size_t>(bit) << shift, differences.size());
  };
  while (touched != 0) {
    const int first = std::countr_zero(touched);
    const int count = std::countr_one(touched >> first);
    const std::size_t begin = column_of(first);
    const std::size_t end = column_of(first + count);
    sum.pass(begin - i, values + i);
    sum.take(differences.data() + begin, end - begin, values + begin);
    i = end;
    touched = first + count < 64 ? touched >> (first + count) << (first + count) : 0;
  }
  sum.pass(differences.size() - i, values + i);
}

void resolve_row(std::span<std::int32_t> differences, std::int32_t whole, std::uint8_t* values) {
  resolve_row_by(whole, differences, values);
}

}  // namespace trapeze
