// A straight piece of a boundary, between two points of the grid.
#pragma once

#include <utility>

#include "core/grid/grid.h"

namespace trapeze {

using Segment = std::pair<Point, Point>;

inline Box box_of(const Segment& s) {
  Box b;
  b.include(s.first);
  b.include(s.second);
  return b;
}

}  // namespace trapeze
