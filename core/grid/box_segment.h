// Boxes and straight lines between two points of the grid.
#pragma once

#include "core/grid/grid.h"

namespace trapeze {

/// Whether the line between the points, including its ends, shares a point with the box. Exact.
constexpr bool meets(Point from, Point to, const Box& box) {
  Box around;
  around.include(from);
  around.include(to);
  if (!around.intersects(box)) return false;
  // The corners of the box that are farthest to either side of a line that descends eastwards, and
  // of one that descends westwards.
  const bool descends_eastwards = (to.x >= from.x) == (to.y >= from.y);
  const Point one = {descends_eastwards ? box.min_x : box.max_x, box.max_y};
  const Point other = {descends_eastwards ? box.max_x : box.min_x, box.min_y};
  const auto side = orientation(from, to, one);
  const auto other_side = orientation(from, to, other);
  return (side <= 0 || other_side <= 0) && (side >= 0 || other_side >= 0);
}

}  // namespace trapeze
