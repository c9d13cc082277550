#include "core/borders/box_ties.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace trapeze {
namespace {

/// Unites the owners of boxes that intersect, by a sweep from north to south over strips that
/// contain about the same number of boxes, and from west to east within each strip.
class BoxTies {
 public:
  BoxTies(std::span<const Box> boxes, std::span<const std::uint32_t> owners, DisjointSets& sets)
      : boxes_(boxes),
        owners_(owners),
        sets_(sets),
        steps_left_(kMostStepsOfEach * (boxes.size() + kLeastStrip)) {}

  void tie() {
    std::vector<std::uint32_t> order(boxes_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, {}, [this](std::uint32_t i) { return std::pair(boxes_[i].min_y, i); });
    for (std::size_t begin = 0; begin < order.size();) {
      const std::int32_t north = boxes_[order[begin]].min_y;
      std::erase_if(strip_, [&](std::uint32_t i) { return boxes_[i].max_y < north; });
      // At least as many boxes as extend into the strip, so that these are not examined too often.
      const std::size_t size = std::max(kLeastStrip, strip_.size());
      const std::size_t end = std::min(begin + size, order.size());
      strip_.insert(strip_.end(), order.begin() + static_cast<std::ptrdiff_t>(begin),
                    order.begin() + static_cast<std::ptrdiff_t>(end));
      tie_strip();
      begin = end;
    }
  }

 private:
  static constexpr std::size_t kLeastStrip = 4096;
  // Beyond that, boxes of a strip are united that need not be: groups become larger, but not wrong.
  static constexpr std::size_t kMostStepsOfEach = 4096;

  void tie_strip() {
    std::ranges::sort(strip_, {},
                      [this](std::uint32_t i) { return std::pair(boxes_[i].min_x, i); });
    open_.clear();
    for (const std::uint32_t i : strip_) {
      if (steps_left_ < open_.size()) {
        if (!open_.empty()) sets_.tie(owners_[open_.front()], owners_[i]);
        open_.assign(1, i);
        continue;
      }
      steps_left_ -= open_.size();
      sweep_over(i);
    }
  }

  void sweep_over(std::uint32_t i) {
    const Box& box = boxes_[i];
    bool is_hidden = false;  // any later box that intersects it also intersects another open one
    std::erase_if(open_, [&](std::uint32_t other) {
      const Box& open = boxes_[other];
      if (open.max_x < box.min_x) return true;
      if (open.min_y > box.max_y || open.max_y < box.min_y) return false;
      sets_.tie(owners_[other], owners_[i]);
      if (open.max_x >= box.max_x && open.min_y <= box.min_y && open.max_y >= box.max_y) {
        is_hidden = true;
        return false;
      }
      return open.max_x <= box.max_x && open.min_y >= box.min_y && open.max_y <= box.max_y;
    });
    if (!is_hidden) open_.push_back(i);
  }

  std::span<const Box> boxes_;
  std::span<const std::uint32_t> owners_;
  DisjointSets& sets_;
  std::size_t steps_left_;
  std::vector<std::uint32_t> strip_;
  std::vector<std::uint32_t> open_;
};

}  // namespace

void tie_meeting(std::span<const Box> boxes, std::span<const std::uint32_t> owners,
                 DisjointSets& sets) {
  BoxTies(boxes, owners, sets).tie();
}

}  // namespace trapeze
