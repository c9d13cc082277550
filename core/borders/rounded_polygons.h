// Rounds the corners of polygons exactly as they are drawn with round corners (see
// corner_rounding.h): the same corners with the same curves.
//
// A border shared by polygons of one graph has the same points on both sides. Curves are rounded to
// cells, which may move the rest of an edge by less than a cell. Where it would thereby cross
// another edge of its graph, the corners of both stay sharp. The drawn curve there differs by less
// than the rounding.
#pragma once

#include <cstddef>
#include <span>

#include "core/borders/drawn_polygons.h"

namespace trapeze {

struct RoundingSize {
  double radius = 0;  // how far from a vertex its edges may be rounded, in pixels
  double pixel = 1;   // cells
};

/// A corner shared by neighbours counts once.
struct RoundedCorners {
  std::size_t rounded = 0;
  std::size_t refused = 0;  // drawn round, but sharp here because an edge would cross another
};

/// Replaces polygons by polygons with round corners. Polygons that overlap others keep their
/// corners, and so do other polygons along the same edges. If the edges of a graph do not cross, as
/// the topological consistency test ensures, its polygons overlap nowhere that they did not before,
/// and no gap arises between them. Cuts at the edges of the map stay sharp (see is_on_frame()).
/// Runs on up to `threads` threads; the result does not depend on their number. Throws
/// std::length_error if there are more vertices than 32 bits can count.
RoundedCorners round_corners(std::span<DrawnPolygons* const> features, const RoundingSize& size,
                             unsigned threads = 1);

}  // namespace trapeze
