#include "core/labels/label_placement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "core/grid/grid.h"

namespace trapeze {
namespace {

constexpr double kPixelsOfWorld = 256;  // at zoom 0
constexpr double kBucketPixels = 256;   // width and height of a bucket, at the step at which a
                                        // label is first shown
constexpr std::uint32_t kNone = 0xffffffff;

const std::array<double, LabelPlacement::kSteps>& scales() {
  static const std::array<double, LabelPlacement::kSteps> made = [] {
    std::array<double, LabelPlacement::kSteps> all{};
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double zoom = LabelPlacement::kFirstZoom + static_cast<double>(i) / 2;
      all[i] = std::exp2(zoom) * kPixelsOfWorld / static_cast<double>(kGridSize);
    }
    return all;
  }();
  return made;
}

/// The first step that reaches that many pixels per cell; kSteps if none does.
int first_step_from(double pixels_per_cell) {
  const auto& all = scales();
  // A step counts as reached if only a rounding error is missing.
  const auto reached = std::ranges::lower_bound(all, pixels_per_cell * (1 - 1e-12));
  return static_cast<int>(reached - all.begin());
}

std::int64_t bucket_at(double cells, double scale) {
  return static_cast<std::int64_t>(std::floor(cells * scale / kBucketPixels));
}

/// In order of rows and columns.
std::uint64_t bucket_of(std::int64_t column, std::int64_t row) {
  constexpr std::int64_t kMiddle = std::int64_t{1} << 31;
  return static_cast<std::uint64_t>(row + kMiddle) << 32 |
         static_cast<std::uint64_t>(column + kMiddle);
}

/// The labels shown at one step, indexed by place.
class Shown {
 public:
  Shown(std::span<const LabelCandidate> candidates, double world_width, double side_x,
        double side_y)
      : candidates_(candidates), world_width_(world_width), side_x_(side_x), side_y_(side_y) {}

  /// Starts the step with the labels that are already shown.
  void begin(int step, std::span<const std::uint32_t> numbers, std::size_t most) {
    scale_ = scales()[static_cast<std::size_t>(step)];
    std::size_t slots = 64;
    while (slots < 2 * most) slots *= 2;
    heads_.assign(slots, kNone);
    items_.clear();
    // On a plane that repeats, columns repeat too.
    columns_ = world_width_ > 0 ? std::max<std::int64_t>(
                                      1, static_cast<std::int64_t>(world_width_ * scale_ / side_x_))
                                : 0;
    column_cells_ = columns_ > 0 ? world_width_ / static_cast<double>(columns_) : side_x_ / scale_;
    for (const std::uint32_t number : numbers) add(number);
  }

  void add(std::uint32_t number) {
    const LabelCandidate& c = candidates_[number];
    const std::size_t slot = slot_of(column_of(c.x), row_of(c.y));
    items_.push_back({number, heads_[slot]});
    heads_[slot] = static_cast<std::uint32_t>(items_.size() - 1);
  }

  /// Some label that overlaps the candidate; kNone if there is none.
  std::uint32_t find_overlapping(std::uint32_t number) const {
    const LabelCandidate& c = candidates_[number];
    const std::int64_t column = column_of(c.x);
    const std::int64_t row = row_of(c.y);
    for (std::int64_t y = row - 1; y <= row + 1; ++y) {
      for (std::int64_t x = column - 1; x <= column + 1; ++x) {
        for (std::uint32_t i = heads_[slot_of(x, y)]; i != kNone; i = items_[i].next) {
          if (overlap(c, candidates_[items_[i].number])) return items_[i].number;
        }
      }
    }
    return kNone;
  }

  /// The scale, in pixels per cell, from which on the two do not overlap.
  double parting_scale(std::uint32_t one, std::uint32_t other) const {
    const LabelCandidate& a = candidates_[one];
    const LabelCandidate& b = candidates_[other];
    const auto part = [](double pixels, double cells) {
      return cells > 0 ? pixels / cells : std::numeric_limits<double>::infinity();
    };
    return std::min(part(static_cast<double>(a.half_width) + b.half_width, across(a.x, b.x)),
                    part(static_cast<double>(a.half_height) + b.half_height, std::abs(a.y - b.y)));
  }

 private:
  struct Item {
    std::uint32_t number;
    std::uint32_t next;
  };

  std::int64_t column_of(double x) const {
    return static_cast<std::int64_t>(std::floor(x / column_cells_));
  }
  std::int64_t row_of(double y) const {
    return static_cast<std::int64_t>(std::floor(y * scale_ / side_y_));
  }
  std::size_t slot_of(std::int64_t column, std::int64_t row) const {
    if (columns_ > 0) column = ((column % columns_) + columns_) % columns_;
    const std::uint64_t mixed = (static_cast<std::uint64_t>(column) * 0x9e3779b97f4a7c15U) ^
                                (static_cast<std::uint64_t>(row) * 0xc2b2ae3d27d4eb4fU);
    return static_cast<std::size_t>((mixed ^ (mixed >> 32)) & (heads_.size() - 1));
  }
  /// The distance from west to east, in cells, the shorter way round.
  double across(double a, double b) const {
    double apart = std::abs(a - b);
    if (world_width_ > 0) {
      apart = std::fmod(apart, world_width_);
      apart = std::min(apart, world_width_ - apart);
    }
    return apart;
  }
  bool overlap(const LabelCandidate& a, const LabelCandidate& b) const {
    return across(a.x, b.x) * scale_ <
               static_cast<double>(a.half_width) + b.half_width - kTouching &&
           std::abs(a.y - b.y) * scale_ <
               static_cast<double>(a.half_height) + b.half_height - kTouching;
  }

  static constexpr double kTouching = 1e-6;  // pixels

  std::span<const LabelCandidate> candidates_;
  double world_width_;
  double side_x_;  // pixels: the width of the widest label and the height of the highest
  double side_y_;
  double scale_ = 1;
  double column_cells_ = 1;
  std::int64_t columns_ = 0;  // around the world; 0: the plane does not repeat
  std::vector<std::uint32_t> heads_;
  std::vector<Item> items_;
};

}  // namespace

LabelPlacement::LabelPlacement(std::vector<LabelCandidate> candidates, double world_width)
    : candidates_(std::move(candidates)), first_step_(candidates_.size(), kSteps) {
  place(world_width);
  sort_by_place();
}

// A label blocked by another one is not tried again before the scale at which the two no longer
// overlap.
void LabelPlacement::place(double world_width) {
  double most_width = 1;
  double most_height = 1;
  std::vector<std::vector<std::uint32_t>> due(kSteps);  // by step
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const LabelCandidate& c = candidates_[i];
    most_width = std::max(most_width, 2.0 * c.half_width);
    most_height = std::max(most_height, 2.0 * c.half_height);
    double scale = c.least_scale;
    // A label must not overlap itself across the edge of the world.
    if (world_width > 0) scale = std::max(scale, 2.0 * c.half_width / world_width);
    const int step = first_step_from(scale);
    if (step < kSteps) due[static_cast<std::size_t>(step)].push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<std::uint32_t> shown;
  Shown at_step(candidates_, world_width, most_width, most_height);
  for (int step = 0; step < kSteps; ++step) {
    std::vector<std::uint32_t>& now = due[static_cast<std::size_t>(step)];
    if (now.empty()) continue;
    std::ranges::sort(now);
    at_step.begin(step, shown, shown.size() + now.size());
    for (const std::uint32_t number : now) {
      const std::uint32_t other = at_step.find_overlapping(number);
      if (other == kNone) {
        first_step_[number] = static_cast<std::uint8_t>(step);
        shown.push_back(number);
        at_step.add(number);
        continue;
      }
      const int later = std::max(first_step_from(at_step.parting_scale(number, other)), step + 1);
      if (later < kSteps) due[static_cast<std::size_t>(later)].push_back(number);
    }
    now = {};
  }
}

void LabelPlacement::sort_by_place() {
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (first_step_[i] == kSteps) continue;
    const LabelCandidate& c = candidates_[i];
    const double scale = scales()[first_step_[i]];
    placed_.push_back(
        {bucket_of(bucket_at(c.x, scale), bucket_at(c.y, scale)), static_cast<std::uint32_t>(i)});
    most_half_width_ = std::max(most_half_width_, c.half_width);
    most_half_height_ = std::max(most_half_height_, c.half_height);
  }
  std::ranges::sort(placed_, [this](const Placed& a, const Placed& b) {
    const auto key = [this](const Placed& p) {
      return std::tuple(first_step_[p.number], p.bucket, p.number);
    };
    return key(a) < key(b);
  });
  step_ends_.assign(kSteps, 0);
  for (const Placed& p : placed_) ++step_ends_[first_step_[p.number]];
  for (std::size_t step = 1; step < step_ends_.size(); ++step) {
    step_ends_[step] += step_ends_[step - 1];
  }
}

std::optional<int> LabelPlacement::step_of(double pixels_per_cell) {
  const auto& all = scales();
  // The sides of windows are rounded to cells, so that pixels of windows side by side differ; at
  // half zooms, they must get the same step. Labels then overlap by no more than that share of
  // their size.
  constexpr double kRounding = 5e-4;
  const auto above = std::ranges::upper_bound(all, pixels_per_cell * (1 + kRounding));
  if (above == all.begin()) return std::nullopt;
  return static_cast<int>(above - all.begin()) - 1;
}

double LabelPlacement::pixels_per_cell_of(int step) {
  return scales()[static_cast<std::size_t>(step)];
}

void LabelPlacement::find(const PlaneBox& box, double pixels_per_cell, double slack,
                          std::vector<std::uint32_t>& numbers) const {
  const std::optional<int> last = step_of(pixels_per_cell);
  if (!last) return;
  const double reach_x = (most_half_width_ + slack) / pixels_per_cell;
  const double reach_y = (most_half_height_ + slack) / pixels_per_cell;
  std::size_t begin = 0;
  for (int step = 0; step <= *last; ++step) {
    const std::size_t end = step_ends_[static_cast<std::size_t>(step)];
    if (begin == end) continue;
    const double scale = scales()[static_cast<std::size_t>(step)];
    const std::int64_t first_column = bucket_at(box.min_x - reach_x, scale);
    const std::int64_t last_column = bucket_at(box.max_x + reach_x, scale);
    const std::int64_t last_row = bucket_at(box.max_y + reach_y, scale);
    const auto of_step = std::span(placed_).subspan(begin, end - begin);
    for (std::int64_t row = bucket_at(box.min_y - reach_y, scale); row <= last_row; ++row) {
      auto next =
          std::ranges::lower_bound(of_step, bucket_of(first_column, row), {}, &Placed::bucket);
      const std::uint64_t last_bucket = bucket_of(last_column, row);
      for (; next != of_step.end() && next->bucket <= last_bucket; ++next) {
        const LabelCandidate& c = candidates_[next->number];
        const double half_x = (c.half_width + slack) / pixels_per_cell;
        const double half_y = (c.half_height + slack) / pixels_per_cell;
        if (c.x + half_x < box.min_x || c.x - half_x > box.max_x || c.y + half_y < box.min_y ||
            c.y - half_y > box.max_y) {
          continue;
        }
        numbers.push_back(next->number);
      }
    }
    begin = end;
  }
}

bool LabelPlacement::is_any_from(const PlaneBox& box, double pixels_per_cell, double slack) const {
  std::vector<std::uint32_t> numbers;
  find(box, pixels_per_cell, slack, numbers);
  if (!numbers.empty()) return true;
  // Labels of later steps extend less far on the ground than they would at this scale.
  const double reach_x = (most_half_width_ + slack) / pixels_per_cell;
  const double reach_y = (most_half_height_ + slack) / pixels_per_cell;
  const int after = step_of(pixels_per_cell).value_or(-1) + 1;
  for (int step = after; step < kSteps; ++step) {
    const auto i = static_cast<std::size_t>(step);
    const std::size_t begin = i == 0 ? 0 : step_ends_[i - 1];
    const auto of_step = std::span(placed_).subspan(begin, step_ends_[i] - begin);
    const double scale = scales()[i];
    const std::int64_t first_column = bucket_at(box.min_x - reach_x, scale);
    const std::int64_t last_column = bucket_at(box.max_x + reach_x, scale);
    const std::int64_t last_row = bucket_at(box.max_y + reach_y, scale);
    for (std::int64_t row = bucket_at(box.min_y - reach_y, scale); row <= last_row; ++row) {
      const auto next =
          std::ranges::lower_bound(of_step, bucket_of(first_column, row), {}, &Placed::bucket);
      // There may be more rows than labels.
      if (next == of_step.end()) break;
      if (next->bucket <= bucket_of(last_column, row)) return true;
      const auto next_row = static_cast<std::int64_t>(next->bucket >> 32) - (std::int64_t{1} << 31);
      row = std::max(row, next_row - 1);
    }
  }
  return false;
}

std::size_t LabelPlacement::memory() const {
  return candidates_.capacity() * sizeof(LabelCandidate) + first_step_.capacity() +
         placed_.capacity() * sizeof(Placed);
}

}  // namespace trapeze
