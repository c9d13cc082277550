// Polygons that grow where they are narrow, as they are drawn (see exaggeration.h).
//
// A polygon becomes its former area plus the triangles by which it grows, minus the triangles of
// others that grow over it. All of them are noded together on the grid, so polygons that come to
// touch have the same points on both sides: no overlap and no gap arises between them that was not
// there before.
//
//     triangles end on cells,         +-----------+        an area left over between them, or of
//     beside the edge on which     ___|  growth   |___     another polygon below them, is less than
//     they stand              ----'---------------'----    a cell wide and becomes a part of the
//                                   polygon                neighbour with the longest border
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/borders/drawn_polygons.h"

namespace trapeze {

struct GrowthSize {
  double width = 0;  // the width to which polygons grow, in pixels
  double pixel = 1;  // cells
};

struct GrownPolygons {
  std::size_t grown = 0;  // number of features that grow anywhere
  std::string failure;    // why they could not be united, in which case they are unchanged; empty
                          // otherwise
};

/// Replaces polygons by the grown ones, everywhere in one step. Polygons that overlap others stay
/// unchanged and do not obstruct others. All features that could grow count as features of one
/// graph from then on: the graph of the first of them. Nothing grows where polygons were cut off
/// (see is_on_frame()). Runs on up to `threads` threads; the result does not depend on their
/// number. Throws std::length_error if there are more vertices than 32 bits can count.
GrownPolygons grow(std::span<DrawnPolygons* const> features, const GrowthSize& size,
                   unsigned threads = 1);

}  // namespace trapeze
