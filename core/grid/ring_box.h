// Bounding boxes of rings, and boxes within boxes.
#pragma once

#include <span>

#include "core/grid/grid.h"

namespace trapeze {

/// The bounding box of the ring; empty if it has no points.
inline Box box_of(std::span<const Point> ring) {
  Box box;
  for (const Point p : ring) box.include(p);
  return box;
}

/// Whether no part of the inner box lies outside the outer one.
constexpr bool holds(const Box& outer, const Box& inner) {
  return outer.min_x <= inner.min_x && outer.min_y <= inner.min_y && outer.max_x >= inner.max_x &&
         outer.max_y >= inner.max_y;
}

}  // namespace trapeze
