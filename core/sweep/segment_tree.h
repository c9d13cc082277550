// Finds the segments whose bounding boxes meet a region.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/grid/grid.h"
#include "core/sweep/segment.h"

namespace trapeze {

/// Pairs of a position along a space-filling curve and the index of a segment, sorted: segments
/// near each other on the map are near each other in the array, and so share boxes of a tree.
std::vector<std::pair<std::uint32_t, std::uint32_t>> order_by_place(
    const std::vector<Segment>& segments);

/// A static tree of boxes (a packed R-tree): each leaf holds kFanout successive segments. The
/// segments must be sorted as by order_by_place() and must outlive the tree.
class SegmentTree {
 public:
  explicit SegmentTree(const std::vector<Segment>& segments) : segments_(segments) {
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < segments.size(); i += kFanout) {
      Box b;
      for (std::size_t k = i; k < std::min(i + kFanout, segments.size()); ++k)
        b.include(box_of(segments[k]));
      boxes.push_back(b);
    }
    heights_.push_back(std::move(boxes));
    while (heights_.back().size() > 1) {
      std::vector<Box> parents;
      const std::vector<Box>& below = heights_.back();
      for (std::size_t i = 0; i < below.size(); i += kFanout) {
        Box b;
        for (std::size_t k = i; k < std::min(i + kFanout, below.size()); ++k) b.include(below[k]);
        parents.push_back(b);
      }
      heights_.push_back(std::move(parents));
    }
  }

  static std::size_t leaf_begin(std::size_t leaf) { return leaf * kFanout; }
  std::size_t leaf_end(std::size_t leaf) const {
    return std::min((leaf + 1) * kFanout, segments_.size());
  }

  /// Calls visit(leaf) for every leaf whose box meets the region, as decided by
  /// region.intersects(box).
  template <class Region, class Visit>
  void query(const Region& region, const Visit& visit) const {
    if (!segments_.empty()) descend(heights_.size() - 1, 0, region, visit);
  }

 private:
  static constexpr std::size_t kFanout = 8;

  template <class Region, class Visit>
  void descend(std::size_t height, std::size_t index, const Region& region,
               const Visit& visit) const {
    if (!region.intersects(heights_[height][index])) return;
    if (height == 0) return visit(index);
    const std::size_t begin = index * kFanout;
    const std::size_t end = std::min(begin + kFanout, heights_[height - 1].size());
    for (std::size_t i = begin; i < end; ++i) descend(height - 1, i, region, visit);
  }

  const std::vector<Segment>& segments_;
  std::vector<std::vector<Box>> heights_;
};

}  // namespace trapeze
