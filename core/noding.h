// Noding on the integer grid: rings that cross, touch or overlap become edges that meet only at
// common vertices.
//
// Snap rounding (Hobby 1999; Guibas and Marimont 1998): the cell around every vertex and around every
// rounded crossing is "hot", and each segment is led through the centres of all hot cells that it
// passes. No point moves by more than half a cell in x and y, and the result has no crossing left.
// Pieces that then coincide cancel in pairs (even-odd).
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/grid.h"
#include "core/rings.h"

namespace trapeze {

using Segment = std::pair<Point, Point>;

/// All segments of the rings, from each point to the next.
std::vector<Segment> segments_of(const Rings& rings);

/// Leads the segments through all hot cells and returns the pieces; each piece once, upper end
/// first, those that coincide an even number of times not at all. `crossings`, if given, counts the
/// pairs of segments that crossed or touched other than at a common end.
std::vector<Segment> node_segments(std::vector<Segment> segments, std::size_t* crossings = nullptr);

}  // namespace trapeze
