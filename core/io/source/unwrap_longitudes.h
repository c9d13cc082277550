// Rings that come from a plane and whose longitudes are wrapped into [-180, 180].
#pragma once

#include "core/io/source/clip_ring.h"
#include "core/io/source/cut_edges.h"

namespace trapeze {

/// The plane from which a ring comes.
struct SourcePlane {
  PointMap to_lonlat;
  double metres_per_unit = 0;
};

/// Undoes the jumps in the longitudes of a ring from one side of the world to the other, so that
/// each edge leads as far east or west as it does on the plane; a ring around a pole is led over
/// that pole. `on_plane` holds the vertices of the ring before they were transformed to degrees. An
/// edge that may extend halfway around the world or more is followed on the plane. If a part of
/// such an edge cannot be transformed, or it passes over a pole, it is taken to go the shorter way;
/// the same applies to the last edges of a ring that has very many of them.
void unwrap_longitudes(PositionRing& ring, const PositionRing& on_plane, const SourcePlane& plane);

}  // namespace trapeze
