// Finds the segments whose boxes meet a box.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/grid/grid.h"
#include "core/sweep/segment.h"

namespace trapeze {

/// The numbers of the segments, each after a number for its place, in an order of place: what is
/// near on the map comes near in the array, and so under the same boxes of a tree.
std::vector<std::pair<std::uint32_t, std::uint32_t>> order_by_place(
    const std::vector<Segment>& segments);

/// A static tree of boxes: leaves hold kFanout successive segments each, which are to be in an
/// order of place and must outlive the tree.
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
    levels_.push_back(std::move(boxes));
    while (levels_.back().size() > 1) {
      std::vector<Box> parents;
      const std::vector<Box>& below = levels_.back();
      for (std::size_t i = 0; i < below.size(); i += kFanout) {
        Box b;
        for (std::size_t k = i; k < std::min(i + kFanout, below.size()); ++k) b.include(below[k]);
        parents.push_back(b);
      }
      levels_.push_back(std::move(parents));
    }
  }

  std::size_t leaf_count() const { return segments_.empty() ? 0 : levels_.front().size(); }
  const Box& leaf_box(std::size_t leaf) const { return levels_.front()[leaf]; }
  static std::size_t leaf_begin(std::size_t leaf) { return leaf * kFanout; }
  std::size_t leaf_end(std::size_t leaf) const {
    return std::min((leaf + 1) * kFanout, segments_.size());
  }

  /// Calls visit(leaf) for every leaf whose box meets `box` and whose number is >= `from`.
  template <class Visit>
  void query(const Box& box, std::size_t from, const Visit& visit) const {
    if (!segments_.empty()) descend(levels_.size() - 1, 0, box, from, visit);
  }

 private:
  static constexpr std::size_t kFanout = 8;

  template <class Visit>
  void descend(std::size_t level, std::size_t index, const Box& box, std::size_t from,
               const Visit& visit) const {
    if (!levels_[level][index].intersects(box)) return;
    if (level == 0) return visit(index);
    // Subtrees that end before `from` hold nothing of interest.
    std::size_t span = 1;
    for (std::size_t l = 1; l < level; ++l) span *= kFanout;
    const std::size_t begin = index * kFanout;
    const std::size_t end = std::min(begin + kFanout, levels_[level - 1].size());
    for (std::size_t i = begin; i < end; ++i) {
      if ((i + 1) * span > from) descend(level - 1, i, box, from, visit);
    }
  }

  const std::vector<Segment>& segments_;
  std::vector<std::vector<Box>> levels_;
};

}  // namespace trapeze
