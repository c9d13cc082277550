// Polygons that grow where they are narrow, as they are drawn so (see exaggeration.h).
//
// A polygon becomes what it was with the triangles by which it grows, less those of others that
// grow over it. All of them are noded together on the grid, so that those that come to touch have
// the same points on both sides: there is no place that two of them cover, nor one between them
// that none does, but where that was so before.
//
//     triangles end on cells,         +-----------+        what is left over between them, or of
//     beside the edge on which     ___|  growth   |___     another polygon below them, is less than
//     they stand              ----'---------------'----    a cell wide, and becomes a part of the
//                                   polygon                neighbour with the longest border
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/borders/drawn_polygons.h"

namespace trapeze {

struct GrowthSize {
  double width = 0;  // to which polygons grow, in pixels
  double pixel = 1;  // cells
};

struct GrownPolygons {
  std::size_t grown = 0;  // features of which anything grows
  std::string failure;    // why they could not be united, in which case they are as they were
};

/// Replaces polygons by what they are grown, in all places at once. Those that lie over others stay
/// as they are, and are not in the way. Whatever could grow is taken for features of one graph from
/// then on: that of the first of them. Nothing grows where polygons were cut off (see
/// is_on_frame()). On up to `threads` threads; the result does not depend on their number. Throws
/// std::length_error if there are more vertices than 32 bits count.
GrownPolygons grow(std::span<DrawnPolygons* const> features, const GrowthSize& size,
                   unsigned threads = 1);

}  // namespace trapeze
