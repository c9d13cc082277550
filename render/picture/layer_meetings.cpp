#include "render/picture/layer_meetings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "render/mask/row_bits.h"

namespace trapeze {
namespace {

constexpr int kAll = 255;
// Layers that fill a pixel together by chance rarely correlate this much around it.
constexpr double kLeastOfNested = 0.5;

bool is_partial(std::uint8_t value) {
  return value != 0 && value != kAll;
}

// In as few steps as are visible, so that few colours result.
std::int8_t to_relation(double correlation) {
  constexpr int kSteps = 7;
  return static_cast<std::int8_t>(std::lround(correlation * kSteps) * (Meeting::kNested / kSteps));
}

std::uint8_t to_gap(double share) {
  constexpr int kSteps = 5;
  return static_cast<std::uint8_t>(std::lround(share * kSteps) * (kAll / kSteps));
}

/// Whether the part of a pixel that two layers leave uncovered is within rounding error.
bool is_whole(int below, int above) {
  return std::abs(below + above - kAll) <= 2;
}

/// The share of the area left uncovered by two layers that is between them only because their
/// borders were simplified, if they are side by side. Anything wider than twice the tolerance is
/// not.
double gap_between(int below, int above, double tolerance) {
  const double left = std::max(0, kAll - below - above) / double{kAll};
  if (tolerance <= 0) return 0;
  return std::clamp(2 - left / tolerance, 0.0, 1.0);
}

}  // namespace

void LayerMeetings::RowsAround::begin(const Mask& mask) {
  mask_ = &mask;
  rows_.fill(-1);
  stride_ = static_cast<std::size_t>(mask.width()) + Mask::kCopyRoom;
  values_.resize(kRows * stride_);
}

void LayerMeetings::RowsAround::move_to(int row) {
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, mask_->height() - 1); ++y) {
    const std::size_t slot = slot_of(y);
    if (rows_[slot] == y) continue;
    rows_[slot] = y;
    mask_->copy_row(y, values_.data() + slot * stride_);
  }
}

void LayerMeetings::find(std::span<PaintedLayer> layers, std::span<const double> tolerances,
                         int width, int height) {
  width_ = width;
  height_ = height;
  if (meetings_.size() < layers.size()) meetings_.resize(layers.size());
  const Mask* below = nullptr;
  double tolerance = 0;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    std::vector<Meeting>& meetings = meetings_[k];
    meetings.clear();
    tolerance = std::max(tolerance, tolerances[k]);
    const bool is_full = std::ranges::any_of(
        layers[k].classes, [](const PaintedClass& one) { return one.mask == nullptr; });
    if (is_full) return;  // no layer above can partly cover a pixel
    const Mask* above = cover_of(layers[k]);
    if (above == nullptr) continue;
    if (below != nullptr) {
      find_contested(*below, *above);
      meet(tolerance, meetings);
      layers[k].meetings = meetings;
    }
    if (k + 1 == layers.size()) return;
    if (below == nullptr && above != &sum_) {
      below = above;
      continue;
    }
    if (below == nullptr) {
      std::swap(union_, sum_);
    } else {
      add_to_union(*below, *above, meetings);
    }
    below = &union_;
  }
}

/// The mask of all its classes together; null if there are none.
const Mask* LayerMeetings::cover_of(const PaintedLayer& layer) {
  const Mask* cover = nullptr;
  for (const PaintedClass& one : layer.classes) {
    if (one.is_beneath) continue;
    if (cover == nullptr) {
      cover = one.mask;
      continue;
    }
    next_.begin(width_, height_);
    for (int row = 0; row < height_; ++row) {
      for_each_run_of_both(cover->row(row), one.mask->row(row),
                           [this](std::size_t end, int a, int b) {
                             next_.append(end, static_cast<std::uint8_t>(std::min(a + b, kAll)));
                           });
      next_.end_row();
    }
    std::swap(sum_, next_);
    cover = &sum_;
  }
  return cover;
}

// Few pixels are partly covered by both.
void LayerMeetings::find_contested(const Mask& below, const Mask& above) {
  contested_.clear();
  below_.begin(below);
  above_.begin(above);
  for (int row = 0; row < height_; ++row) {
    partial_below_.assign(words_for(static_cast<std::size_t>(width_)), 0);
    partial_above_.assign(partial_below_.size(), 0);
    if (!mark_partial(above.row(row), partial_above_)) continue;
    if (!mark_partial(below.row(row), partial_below_)) continue;
    for (std::size_t i = 0; i < partial_below_.size(); ++i) partial_below_[i] &= partial_above_[i];
    const auto first = static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(width_);
    for_each_bit(partial_below_, [&](std::size_t column) {
      contested_.push_back(first + static_cast<std::uint32_t>(column));
    });
  }
}

void LayerMeetings::meet(double tolerance, std::vector<Meeting>& meetings) {
  int last_row = -1;
  for (const std::uint32_t pixel : contested_) {
    const int row = static_cast<int>(pixel) / width_;
    const int column = static_cast<int>(pixel) % width_;
    if (row != last_row) {
      below_.move_to(row);
      above_.move_to(row);
      last_row = row;
    }
    const int lower = below_.row(row)[column];
    const int upper = above_.row(row)[column];
    const double correlation = correlation_around(column, row);
    if (is_whole(lower, upper) && correlation < kLeastOfNested) {
      meetings.push_back({pixel, Meeting::kSideBySide, kAll});
      continue;
    }
    const double gap = correlation < 0 ? -correlation * gap_between(lower, upper, tolerance) : 0;
    const Meeting meeting{pixel, to_relation(correlation), to_gap(gap)};
    if (meeting.relation != 0) meetings.push_back(meeting);
  }
}

/// The correlation of the coverages of the pixel and those around it by the two layers, from -1 to
/// 1; 0 if one of them is constant there.
double LayerMeetings::correlation_around(int column, int row) const {
  const int west = std::max(column - 1, 0);
  const int east = std::min(column + 1, width_ - 1);
  int count = 0;
  int a = 0;
  int b = 0;
  int aa = 0;
  int ab = 0;
  int bb = 0;
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, height_ - 1); ++y) {
    const std::uint8_t* lower_row = below_.row(y);
    const std::uint8_t* upper_row = above_.row(y);
    for (int x = west; x <= east; ++x) {
      const int lower = lower_row[x];
      const int upper = upper_row[x];
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

void LayerMeetings::add_to_union(const Mask& below, const Mask& above,
                                 std::span<const Meeting> meetings) {
  next_.begin(width_, height_);
  auto meeting = meetings.begin();
  std::size_t pixel = 0;
  const auto value_at_next_pixel = [&](std::uint8_t lower, std::uint8_t upper) {
    while (meeting != meetings.end() && meeting->pixel < pixel) ++meeting;
    if (meeting == meetings.end() || meeting->pixel != pixel) {
      return lower + upper - lower * upper / kAll;
    }
    const double covered = covered_by(lower / double{kAll}, upper / double{kAll}, *meeting);
    return static_cast<int>(std::lround(covered * kAll));
  };
  for (int row = 0; row < height_; ++row) {
    const std::size_t first = pixel;
    for_each_run_of_both(below.row(row), above.row(row),
                         [&](std::size_t end, std::uint8_t lower, std::uint8_t upper) {
                           if (!is_partial(lower) || !is_partial(upper)) {
                             // If one of the two is 0 or full, the union is the greater one.
                             next_.append(end, std::max(lower, upper));
                             pixel = first + end;
                           }
                           for (; pixel < first + end; ++pixel) {
                             const int value = value_at_next_pixel(lower, upper);
                             next_.append(pixel - first + 1, static_cast<std::uint8_t>(value));
                           }
                         });
    next_.end_row();
  }
  std::swap(union_, next_);
}

}  // namespace trapeze
