// Rounds the corners of polygons as they are drawn with round corners (see corner_rounding.h): the
// same corners, with the same curves.
//
// A border that polygons of one graph share has the same points on both sides. Curves are rounded
// to cells, which may move what is left of an edge by less than a cell; where it would come to
// cross another edge of its graph so, the corners of both stay sharp. A curve that is drawn there
// differs by less than what is rounded.
#pragma once

#include <cstddef>
#include <span>

#include "core/borders/drawn_polygons.h"

namespace trapeze {

struct RoundingSize {
  double radius = 0;  // how far from a vertex its edges may be rounded, in pixels
  double pixel = 1;   // cells
};

/// One that neighbours have in common counts once.
struct RoundedCorners {
  std::size_t rounded = 0;
  std::size_t refused = 0;  // drawn round, but sharp here, as an edge would come to cross another
};

/// Replaces polygons by what they are with round corners. What lies over others keeps its corners,
/// and those that others have on the same edges. Where the edges of a graph do not cross,
/// as is so with the topological consistency test, polygons of it have no place in common that they
/// did not have before, and none comes about between them. Cuts at the edges of the map stay sharp
/// (see is_on_frame()). On up to `threads` threads; the result does not depend on their number.
/// Throws std::length_error if there are more vertices than 32 bits count.
RoundedCorners round_corners(std::span<DrawnPolygons* const> features, const RoundingSize& size,
                             unsigned threads = 1);

}  // namespace trapeze
