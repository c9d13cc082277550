// A triangle as trapezoids.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "bench/experiment/trapezoid_record.h"

namespace trapeze::experiment {

/// Appends the parts above and below the middle vertex, those without height left out; nothing if
/// the triangle has no area or does not meet `view`. Returns whether it does.
inline bool append_triangle(std::array<Point, 3> corners, const Box& view,
                            std::vector<TrapezoidRecord>& records) {
  std::sort(corners.begin(), corners.end(), is_above);
  const auto [top, middle, bottom] = corners;
  Box box;
  for (const Point p : corners) box.include(p);
  const std::int64_t side = orientation(top, bottom, middle);
  if (side == 0 || !box.intersects(view)) return false;
  const auto append = [&](std::int32_t from, std::int32_t to, Point upper, Point lower) {
    if (from == to) return;
    // The middle vertex lies east of the long side where the orientation is negative.
    if (side < 0) {
      records.push_back({from, to, top, bottom, upper, lower});
    } else {
      records.push_back({from, to, upper, lower, top, bottom});
    }
  };
  append(top.y, middle.y, top, middle);
  append(middle.y, bottom.y, middle, bottom);
  return true;
}

}  // namespace trapeze::experiment
