#include "bench/experiment/beyond_view.h"

namespace trapeze::experiment {
namespace {

/// One bit for each side of the view that p is beyond.
unsigned sides_beyond(Point p, const Box& view) {
  return (p.x < view.min_x ? 1u : 0u) | (p.x > view.max_x ? 2u : 0u) |
         (p.y < view.min_y ? 4u : 0u) | (p.y > view.max_y ? 8u : 0u);
}

}  // namespace

// Replacing a boundary by another one on the far side of a straight line changes nothing on the
// near side.
void append_with_short_cuts(const Rings& rings, std::uint32_t first, std::uint32_t last,
                            const Box& view, Rings& shortened) {
  for (std::uint32_t r = first; r < last; ++r) {
    const auto ring = rings[r];
    const std::size_t begin = shortened.points.size();
    unsigned common = 0;  // sides beyond which all vertices since the last but one remaining are
    for (const Point p : ring) {
      const unsigned sides = sides_beyond(p, view);
      if ((common & sides) != 0) {
        shortened.points.back() = p;
        common &= sides;
      } else {
        // The previous vertex may start a run with this one.
        const bool is_first = shortened.points.size() == begin;
        common = is_first ? 0 : sides_beyond(shortened.points.back(), view) & sides;
        shortened.points.push_back(p);
      }
    }
    if (shortened.points.size() - begin < 3) {
      shortened.points.resize(begin);
    } else {
      shortened.close_ring();
    }
  }
}

}  // namespace trapeze::experiment
