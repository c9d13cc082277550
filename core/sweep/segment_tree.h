// Finds the segments whose bounding boxes meet a box.
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
/// near each other on the map are near each other in the array, and so under the same boxes of a
/// tree.
std::vector<std::pair<std::uint32_t, std::uint32_t>> order_by_place(
    const std::vector<Segment>& segments);

/// A static tree of boxes (a packed R-tree): each leaf holds kFanout successive segments. The
/// segments are to be sorted as by order_by_place() and must outlive the tree.
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

  std::size_t leaf_count() const { return segments_.empty() ? 0 : heights_.front().size(); }
  const Box& leaf_box(std::size_t leaf) const { return heights_.front()[leaf]; }
  static std::size_t leaf_begin(std::size_t leaf) { return leaf * kFanout; }
  std::size_t leaf_end(std::size_t leaf) const {
    return std::min((leaf + 1) * kFanout, segments_.size());
  }

  /// Calls visit(leaf) for every leaf whose box meets `box` and whose number is >= `from`.
  template <class Visit>
  void query(const Box& box, std::size_t from, const Visit& visit) const {
    if (!segments_.empty()) descend(heights_.size() - 1, 0, box, from, visit);
  }

 private:
  static constexpr std::size_t kFanout = 8;

  template <class Visit>
  void descend(std::size_t height, std::size_t index, const Box& box, std::size_t from,
               const Visit& visit) const {
    if (!heights_[height][index].intersects(box)) return;
    if (height == 0) return visit(index);
    // Subtrees that end before leaf `from` are skipped.
    std::size_t span = 1;
    for (std::size_t l = 1; l < height; ++l) span *= kFanout;
    const std::size_t begin = index * kFanout;
    const std::size_t end = std::min(begin + kFanout, heights_[height - 1].size());
    for (std::size_t i = begin; i < end; ++i) {
      if ((i + 1) * span > from) descend(height - 1, i, box, from, visit);
    }
  }

  const std::vector<Segment>& segments_;
  std::vector<std::vector<Box>> heights_;
};

}  // namespace trapeze
