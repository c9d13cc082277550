// The overlaps between features of a layer. They are needed to draw the later feature on top, but
// neighbours that only touch side by side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/stored_array.h"
#include "core/grid/tolerance.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// Two features that overlap at full detail.
struct FeatureOverlap {
  std::uint32_t row = 0;
  std::uint32_t other = 0;
  /// The approximate width of the overlap at its widest, in cells: its area divided by its longest
  /// extent.
  std::uint32_t width = 0;
  /// The length along which both boundaries coincide there, with the insides on the same side, in
  /// cells. They may be up to kAlong cells apart.
  std::uint32_t along = 0;
  static constexpr double kAlong = 32;  // half a metre

  /// An overlap of features of a coverage that share a face: however much their borders are
  /// simplified, it is the same place for both, with the same trapezoids.
  static FeatureOverlap in_common(std::uint32_t row, std::uint32_t other) {
    return {row, other, kInCommon, kInCommon};
  }
  bool is_in_common() const { return width == kInCommon; }

  static constexpr std::uint32_t kInCommon = 0xffffffff;

  friend bool operator==(const FeatureOverlap&, const FeatureOverlap&) = default;
};

/// Finds the overlaps of a feature. Immutable; any number of threads may read.
class OverlapTable {
 public:
  OverlapTable() = default;
  /// From pairs in order of rows. All rows are less than `rows`, as are those that of() accepts.
  /// Throws std::invalid_argument otherwise.
  OverlapTable(StoredArray<FeatureOverlap> pairs, std::size_t rows);

  /// Whether no two features overlap.
  bool empty() const { return pairs_.empty(); }
  /// The overlaps of a feature, in order of the other rows.
  std::span<const FeatureOverlap> of(std::uint32_t row) const {
    if (begins_.empty()) return {};
    return std::span(pairs()).subspan(begins_[row], begins_[row + 1] - begins_[row]);
  }
  /// Whether the feature shares places with others, see FeatureOverlap::in_common().
  bool has_in_common(std::uint32_t row) const {
    return !in_common_.empty() && in_common_[row] != 0;
  }
  bool are_any_in_common() const { return !in_common_.empty(); }
  /// Whether the boundary of the feature runs along that of a feature that it overlaps.
  bool runs_along_another(std::uint32_t row) const {
    return !runs_along_.empty() && runs_along_[row] != 0;
  }
  std::span<const FeatureOverlap> pairs() const { return {pairs_.data(), pairs_.size()}; }
  /// The number of pairs whose boundaries run along each other.
  std::size_t pairs_along() const { return pairs_along_; }
  std::size_t memory() const {
    return pairs_.memory() + begins_.capacity() * sizeof(std::uint32_t) + runs_along_.capacity() +
           in_common_.capacity();
  }

 private:
  StoredArray<FeatureOverlap> pairs_;
  std::vector<std::uint32_t> begins_;  // by row, and the end of the last; empty if there are none
  std::vector<std::uint8_t> runs_along_;  // by row; empty if none does
  std::vector<std::uint8_t> in_common_;   // by row; empty if none has
  std::size_t pairs_along_ = 0;
};

/// Features whose trapezoids at full detail are compared; views of the caller's memory.
struct OverlapInput {
  MeshView mesh;
  std::span<const Lifespan> lifespans;        // by trapezoid, as many as feature_of
  std::span<const std::uint32_t> feature_of;  // row, by trapezoid; further trapezoids of the mesh
                                              // are ignored
  std::span<const std::uint32_t> kinds;       // by row: features of one kind are not compared
  std::span<const Box> boxes;                 // by row: bounding box of the feature; as many as
                                              // kinds
};

struct FeatureOverlaps {
  std::vector<FeatureOverlap> pairs;  // each pair once for either feature, in order of row and
                                      // other
  bool is_complete = true;  // false: there were too many, or finding them would take too long
};

/// Finds overlaps wider than two cells, which is more than snapping borders to the grid can produce
/// between neighbours. Does not depend on the order of trapezoids. The result includes the `known`
/// ones, between features of one kind, which may contain duplicates. Runs on up to `threads`
/// threads; the result does not depend on their number.
FeatureOverlaps find_overlaps(const OverlapInput& input, std::vector<FeatureOverlap> known = {},
                              unsigned threads = 1);

}  // namespace trapeze
