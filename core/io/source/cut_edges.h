// Rings under a projection that turns straight edges into curves: edges are cut so finely that the
// straight pieces drawn between the cuts stay near the curves.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/io/source/clip_ring.h"

namespace trapeze {

/// Replaces coordinates by projected ones; false if a point cannot be projected.
using PointMap = std::function<bool(std::vector<double>& x, std::vector<double>& y)>;

/// A ring before and after projection, point by point.
struct MappedRing {
  PositionRing before;
  PositionRing after;
};

/// How deviation is measured after projection: the distance of a point from the chord between two
/// ends.
using DistanceFromChord = double (*)(Position point, Position from, Position to);

/// On a plane.
double distance_on_plane(Position point, Position from, Position to);
/// For longitudes and latitudes, in metres, never less than on the ground. An edge across the
/// antimeridian counts as straight: it is handled elsewhere.
double metres_of_degrees(Position point, Position from, Position to);

/// Adds points to the edges of `ring.before` and projects all of them into `ring.after`, so that no
/// curve is farther than `most` from the chord drawn in its place. Edges are halved repeatedly;
/// each half is examined at three points. For curves without an inflection, or with one in the
/// middle, these show at least three quarters of the deviation. The cuts of an edge do not depend
/// on its direction, so neighbours stay neighbours. False if a point cannot be projected.
bool cut_edges(MappedRing& ring, const PointMap& map, DistanceFromChord distance, double most);

}  // namespace trapeze
