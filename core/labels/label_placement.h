// Which names are shown at which scale, decided once for the whole world: so that all pictures of a
// map, tiles and windows of any size, agree on every name.
//
// Names, like trapezoids, have lifespans: one that is shown at a scale is shown at all larger
// scales. Scales are taken from the smallest on, in steps of half a zoom. At each step the names
// that are large enough on the ground and not yet shown are taken by priority, and those shown that
// overlap none of those shown before. A name has a fixed place on the ground and a fixed size in
// pixels, so two that do not overlap at one scale do not at any larger one: nothing that is decided
// has to be taken back, and between two steps what the smaller one shows holds.
//
// Thread-safety: immutable once made, any number of threads may read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace trapeze {

/// A name that may be shown. Lengths in pixels are those of a picture of scale 1.
struct LabelCandidate {
  double x = 0;  // of its middle, in cells
  double y = 0;
  float half_width = 0;  // pixels
  float half_height = 0;
  /// The least pixels per cell at which it is shown.
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
  /// Steps of half a zoom; step 0 is zoom kFirstZoom, at which, and at smaller scales, few names
  /// are shown.
  static constexpr int kFirstZoom = -4;
  static constexpr int kSteps = 2 * 28 + 1;

  /// Places candidates, which are in order of priority, the first first. `world_width`: of a plane
  /// that repeats from west to east, its width in cells; 0 of one that does not.
  LabelPlacement(std::vector<LabelCandidate> candidates, double world_width);

  /// The last step that shows as few as the scale, in pixels per cell, allows; nothing below step
  /// 0.
  static std::optional<int> step_of(double pixels_per_cell);
  static double pixels_per_cell_of(int step);

  /// By number, as they were given.
  std::span<const LabelCandidate> candidates() const { return candidates_; }
  /// The first step at which it is shown; kSteps if it never is.
  int first_step_of(std::uint32_t number) const { return first_step_[number]; }
  /// How many are shown at any scale.
  std::size_t size() const { return placed_.size(); }

  /// Appends the numbers of the names shown at that scale whose rectangles, grown by `slack`
  /// pixels, may meet the box. Of a plane that repeats, only those are found whose middle is where
  /// x is as it was given. In no particular order, but in the same for equal arguments.
  void find(const PlaneBox& box, double pixels_per_cell, double slack,
            std::vector<std::uint32_t>& numbers) const;
  /// Whether any name that is shown at that scale or a larger one may meet the box, likewise.
  bool is_any_from(const PlaneBox& box, double pixels_per_cell, double slack) const;

  /// How far from its middle a name may reach at that scale, grown by `slack` pixels, from west to
  /// east, in cells.
  double reach(double pixels_per_cell, double slack) const {
    return (most_half_width_ + slack) / pixels_per_cell;
  }

  std::size_t memory() const;

 private:
  struct Placed {
    std::uint64_t bucket = 0;  // by its column and row, of its first step
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
