// Bounding boxes and areas of rings, and boxes within boxes.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "core/grid/grid.h"

namespace trapeze {

/// The bounding box of the ring; empty if it has no points.
inline Box box_of(std::span<const Point> ring) {
  Box box;
  for (const Point p : ring) box.include(p);
  return box;
}

/// In square cells; not for an empty box.
constexpr double area_of(const Box& box) {
  return (static_cast<double>(box.max_x) - box.min_x) *
         (static_cast<double>(box.max_y) - box.min_y);
}

/// The area within a ring that does not cross itself and has at least one point, in square cells.
inline double area_of_ring(std::span<const Point> ring) {
  double twice = 0;
  const Point origin = ring.front();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point a = ring[i];
    const Point b = ring[i + 1 == ring.size() ? 0 : i + 1];
    twice += (static_cast<double>(a.x) - origin.x) * (static_cast<double>(b.y) - origin.y) -
             (static_cast<double>(b.x) - origin.x) * (static_cast<double>(a.y) - origin.y);
  }
  return std::abs(twice) / 2;
}

/// Whether no part of the inner box lies outside the outer one.
constexpr bool holds(const Box& outer, const Box& inner) {
  return outer.min_x <= inner.min_x && outer.min_y <= inner.min_y && outer.max_x >= inner.max_x &&
         outer.max_y >= inner.max_y;
}

}  // namespace trapeze
