// Rings that come from a plane, whose longitudes are wrapped into one turn of the world.
#pragma once

#include "core/io/source/clip_ring.h"
#include "core/io/source/cut_edges.h"

namespace trapeze {

/// The plane that a ring comes from.
struct SourcePlane {
  PointMap to_lonlat;
  double metres_per_unit = 0;
};

/// Undoes the jumps in the longitudes of a ring from one side of the world to the other, so that
/// each edge leads as far east or west as it does on the plane, and leads a ring around a pole over
/// that pole. `on_plane` has the vertices of the ring before they were brought to degrees. An edge
/// that may be half around the world or more is followed on the plane; one of which a part has no
/// place in degrees, or that runs over a pole, is taken to go the shorter way, and so are the last
/// of a ring of very many such edges.
void unwrap_longitudes(PositionRing& ring, const PositionRing& on_plane, const SourcePlane& plane);

}  // namespace trapeze
