// Which labels are shown at which scale, decided once for the whole world, so that all images of a
// map, tiles and windows of any size, agree on every label.
//
// Labels, like trapezoids, have lifespans: a label shown at a scale is shown at all larger scales.
// Scales are processed from the smallest on, in steps of half a zoom. At each step, the labels that
// are large enough on the ground and not yet shown are tried in order of priority, and those that
// overlap no label already shown are shown. A label has a fixed place on the ground and a fixed
// size in pixels, so two that do not overlap at one scale do not overlap at any larger one: no
// decision has to be revised, and between two steps the labels of the smaller one apply.
//
// Thread-safety: immutable once made; any number of threads may read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace trapeze {

/// A label that may be shown. Lengths in pixels are those of an image of scale 1.
struct LabelCandidate {
  double x = 0;  // of its middle, in cells
  double y = 0;
  float half_width = 0;  // pixels
  float half_height = 0;
  /// The smallest scale, in pixels per cell, at which it may be shown.
  double least_scale = 0;
};

/// A rectangle of the plane, in cells.
struct PlaneBox {
  double min_x = 0;
  double min_y = 0;
  double max_x = 0;
  double max_y = 0;
};

class LabelPlacement {
 public:
  /// Steps of half a zoom. Step 0 is zoom kFirstZoom, at which, and at smaller scales, few labels
  /// are shown.
  static constexpr int kFirstZoom = -4;
  static constexpr int kSteps = 2 * 28 + 1;

  /// Places candidates, given in order of priority, the highest first. `world_width`: the width in
  /// cells of a plane that repeats from west to east; 0 if it does not repeat.
  LabelPlacement(std::vector<LabelCandidate> candidates, double world_width);

  /// The last step whose scale does not exceed the given one, in pixels per cell, except for the
  /// rounding of windows; none below step 0.
  static std::optional<int> step_of(double pixels_per_cell);
  static double pixels_per_cell_of(int step);

  /// By number, in the given order.
  std::span<const LabelCandidate> candidates() const { return candidates_; }
  /// The first step at which the label is shown; kSteps if never.
  int first_step_of(std::uint32_t number) const { return first_step_[number]; }
  /// How many labels are shown at any scale.
  std::size_t size() const { return placed_.size(); }

  /// Appends the numbers of the labels shown at that scale whose rectangles, grown by `slack`
  /// pixels, may intersect the box. On a plane that repeats, labels are found only by the x given
  /// for their middle. The order is unspecified, but the same for equal arguments.
  void find(const PlaneBox& box, double pixels_per_cell, double slack,
            std::vector<std::uint32_t>& numbers) const;
  /// Whether any label shown at that scale or a larger one may intersect the box, with the same
  /// slack.
  bool is_any_from(const PlaneBox& box, double pixels_per_cell, double slack) const;

  /// The greatest distance, in cells from west to east, between a label's middle and its sides at
  /// that scale, grown by `slack` pixels.
  double reach(double pixels_per_cell, double slack) const {
    return (most_half_width_ + slack) / pixels_per_cell;
  }

  std::size_t memory() const;

 private:
  struct Placed {
    std::uint64_t bucket = 0;  // from its column and row, at its first step
    std::uint32_t number = 0;
  };

  void place(double world_width);
  void sort_by_place();

  std::vector<LabelCandidate> candidates_;
  std::vector<std::uint8_t> first_step_;  // by candidate
  std::vector<Placed> placed_;            // by first step, then by bucket
  std::vector<std::size_t> step_ends_;    // of placed_, by step
  float most_half_width_ = 0;
  float most_half_height_ = 0;
};

}  // namespace trapeze
