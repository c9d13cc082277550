// Rings through a map that makes curves of straight edges: cut so finely that what is drawn between
// the cuts stays near the curves.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/io/source/clip_ring.h"

namespace trapeze {

/// Replaces coordinates by those on the other side of a map; false if a point has no place there.
using PointMap = std::function<bool(std::vector<double>& x, std::vector<double>& y)>;

/// A ring on both sides of a map, point by point.
struct MappedRing {
  PositionRing before;
  PositionRing after;
};

/// How an edge is measured after the map: how far the point is from the chord between the two ends.
using DistanceFromChord = double (*)(Position point, Position from, Position to);

/// On a plane.
double distance_on_plane(Position point, Position from, Position to);
/// Of longitudes and latitudes, in metres, never less than on the ground. An edge over the
/// antimeridian counts as straight: it is led over it elsewhere.
double metres_of_degrees(Position point, Position from, Position to);

/// Adds points to the edges of `ring.before` and maps all of them into `ring.after`, so that no
/// curve is farther than `most` from the chord that is drawn in its place. Edges are halved; each
/// half is looked at in three points, at which curves without a bend, and those with one in their
/// middle, show at least three quarters of how far they are. Where an edge is cut does not depend
/// on its direction, so that neighbours stay neighbours. False if a point has no place after the
/// map.
bool cut_edges(MappedRing& ring, const PointMap& map, DistanceFromChord distance, double most);

}  // namespace trapeze
