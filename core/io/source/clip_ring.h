// Sutherland-Hodgman clipping of a closed ring against half-planes parallel to the axes.
//
// A clipped ring may run back and forth along the clip line; such parts enclose no area by
// even-odd.
#pragma once

#include <vector>

namespace trapeze {

struct Position {
  double x = 0;
  double y = 0;

  friend constexpr bool operator==(Position, Position) = default;
};

/// A ring without its closing vertex, with finite coordinates.
using PositionRing = std::vector<Position>;

struct ClipWindow {
  double min_x = 0;
  double min_y = 0;
  double max_x = 0;
  double max_y = 0;
};

/// Removes the parts outside `window`; every remaining vertex lies inside or exactly on its border.
/// The cut of an edge does not depend on the edge's direction, so neighbours that share it stay
/// neighbours. `scratch` keeps its memory between calls.
void clip_ring(PositionRing& ring, const ClipWindow& window, PositionRing& scratch);

}  // namespace trapeze
