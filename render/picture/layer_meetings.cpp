#include "render/picture/layer_meetings.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "render/mask/row_bits.h"

namespace trapeze {
namespace {

constexpr int kAll = 255;
// Layers that fill a pixel together by chance are hardly ever as alike around it.
constexpr double kLeastOfNested = 0.5;

// So many pixels at once, by the vector extensions of g++ and clang.
constexpr std::size_t kBlock = 16;
using Bytes __attribute__((vector_size(kBlock))) = std::uint8_t;

Bytes bytes_at(const std::uint8_t* values) {
  Bytes bytes;
  std::memcpy(&bytes, values, kBlock);
  return bytes;
}

/// Adds values to sums, as far as there is room in them.
void add(std::span<const std::uint8_t> values, std::span<std::uint8_t> sums) {
  std::size_t i = 0;
  for (; i + kBlock <= sums.size(); i += kBlock) {
    const Bytes more = bytes_at(values.data() + i);
    const Bytes sum = bytes_at(sums.data() + i) + more;
    const auto full = reinterpret_cast<Bytes>(sum < more);  // all bits where it did not fit
    const Bytes bounded = sum | full;
    std::memcpy(sums.data() + i, &bounded, kBlock);
  }
  for (; i < sums.size(); ++i) {
    sums[i] = static_cast<std::uint8_t>(std::min(sums[i] + values[i], kAll));
  }
}

// In as few steps as differences can be seen in, so that few colours come of it.
std::int8_t to_relation(double correlation) {
  constexpr int kSteps = 7;
  return static_cast<std::int8_t>(std::lround(correlation * kSteps) * (Meeting::kNested / kSteps));
}

std::uint8_t to_gap(double share) {
  constexpr int kSteps = 5;
  return static_cast<std::uint8_t>(std::lround(share * kSteps) * (kAll / kSteps));
}

/// Whether what two layers leave out of a pixel is no more than what was lost in rounding.
bool is_whole(int below, int above) {
  return std::abs(below + above - kAll) <= 2;
}

/// How much of what two layers leave out, as a share, lies between them only because their borders
/// were simplified, if they lie side by side: what is wider than twice the tolerance does not.
double gap_between(int below, int above, double tolerance) {
  const double left = std::max(0, kAll - below - above) / double{kAll};
  if (tolerance <= 0) return 0;
  return std::clamp(2 - left / tolerance, 0.0, 1.0);
}

}  // namespace

void LayerMeetings::find(std::span<PaintedLayer> layers, std::span<const double> tolerances,
                         int width, int height) {
  width_ = width;
  height_ = height;
  pixels_ = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (meetings_.size() < layers.size()) meetings_.resize(layers.size());
  Values below;
  double tolerance = 0;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    std::vector<Meeting>& meetings = meetings_[k];
    meetings.clear();
    tolerance = std::max(tolerance, tolerances[k]);
    const bool is_full = std::ranges::any_of(
        layers[k].classes, [](const PaintedClass& one) { return one.mask == nullptr; });
    if (is_full) return;  // there is nothing that others could have in part
    const Values above = cover_of(layers[k]);
    if (above.empty()) continue;
    if (!below.empty()) {
      find_contested(below, above);
      meet(below, above, tolerance, meetings);
      layers[k].meetings = meetings;
    }
    if (k + 1 == layers.size()) return;
    if (below.empty() && above.data() != sum_.data()) {
      below = above;
      continue;
    }
    if (below.empty()) {
      union_.swap(sum_);
    } else {
      add_to_union(below, above, meetings);
    }
    below = union_;
  }
}

/// Of its classes together; empty if there are none.
LayerMeetings::Values LayerMeetings::cover_of(const PaintedLayer& layer) {
  const auto counts = [](const PaintedClass& one) { return !one.is_beneath; };
  const auto classes = std::ranges::count_if(layer.classes, counts);
  if (classes == 0) return {};
  if (classes == 1) return std::ranges::find_if(layer.classes, counts)->mask->pixels();
  const auto first = std::ranges::find_if(layer.classes, counts);
  sum_.assign(first->mask->pixels().begin(), first->mask->pixels().end());
  for (auto one = first + 1; one != layer.classes.end(); ++one) {
    if (counts(*one)) add(one->mask->pixels(), sum_);
  }
  return sum_;
}

// In few places both have a part of a pixel: one is looked at only where the other one has.
void LayerMeetings::find_contested(Values below, Values above) {
  contested_.clear();
  partial_.assign(words_for(pixels_), 0);
  if (!mark_partial(above, partial_)) return;
  for (std::size_t word = 0; word < partial_.size(); ++word) {
    if (partial_[word] == 0) continue;
    const std::size_t first = word * 64;
    std::uint64_t both = 0;
    mark_partial(below.subspan(first, std::min<std::size_t>(64, pixels_ - first)), {&both, 1});
    for (both &= partial_[word]; both != 0; both &= both - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(both));
      contested_.push_back(static_cast<std::uint32_t>(first + bit));
    }
  }
}

void LayerMeetings::meet(Values below, Values above, double tolerance,
                         std::vector<Meeting>& meetings) {
  for (const std::uint32_t pixel : contested_) {
    const int lower = below[pixel];
    const int upper = above[pixel];
    const double correlation = correlation_around(pixel, below, above);
    if (is_whole(lower, upper) && correlation < kLeastOfNested) {
      meetings.push_back({pixel, Meeting::kSideBySide, kAll});
      continue;
    }
    const double gap = correlation < 0 ? -correlation * gap_between(lower, upper, tolerance) : 0;
    const Meeting meeting{pixel, to_relation(correlation), to_gap(gap)};
    if (meeting.relation != 0) meetings.push_back(meeting);
  }
}

/// Of how much the two cover of the pixel and those around it, from -1 to 1; 0 if one of them is
/// the same in all.
double LayerMeetings::correlation_around(std::uint32_t pixel, Values below, Values above) const {
  const int row = static_cast<int>(pixel) / width_;
  const int column = static_cast<int>(pixel) % width_;
  const int west = std::max(column - 1, 0);
  const int east = std::min(column + 1, width_ - 1);
  int count = 0;
  int a = 0;
  int b = 0;
  int aa = 0;
  int ab = 0;
  int bb = 0;
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, height_ - 1); ++y) {
    const std::size_t begin = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    for (int x = west; x <= east; ++x) {
      const int lower = below[begin + static_cast<std::size_t>(x)];
      const int upper = above[begin + static_cast<std::size_t>(x)];
      ++count;
      a += lower;
      b += upper;
      aa += lower * lower;
      ab += lower * upper;
      bb += upper * upper;
    }
  }
  const double product =
      static_cast<double>(count * aa - a * a) * static_cast<double>(count * bb - b * b);
  return product > 0 ? static_cast<double>(count * ab - a * b) / std::sqrt(product) : 0;
}

void LayerMeetings::add_to_union(Values below, Values above, std::span<const Meeting> meetings) {
  next_union_.resize(pixels_);
  // Where one of the two is nothing or all, it is the greater one.
  std::transform(below.begin(), below.end(), above.begin(), next_union_.begin(),
                 [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); });
  for (const std::uint32_t pixel : contested_) {
    const int product = below[pixel] * above[pixel] / kAll;
    next_union_[pixel] = static_cast<std::uint8_t>(below[pixel] + above[pixel] - product);
  }
  for (const Meeting& meeting : meetings) {
    const double covered = covered_by(below[meeting.pixel] / double{kAll},
                                      above[meeting.pixel] / double{kAll}, meeting);
    next_union_[meeting.pixel] = static_cast<std::uint8_t>(std::lround(covered * kAll));
  }
  union_.swap(next_union_);
}

}  // namespace trapeze
