// Edges of a subdivision that have different faces on their sides.
#pragma once

#include <utility>
#include <vector>

#include "core/graph/trapezoidal_graph.h"
#include "core/sweep/boundary.h"
#include "core/sweep/trapezoidation.h"

namespace trapeze {

/// The faces to the left and right of each edge.
using Sides = std::vector<std::pair<FaceId, FaceId>>;

/// Makes `graph`, which is that of the boundary, that of the edges with different faces on their
/// sides; only these are left of the boundary and the sides. False if there are none. On up to
/// `threads` threads.
bool keep_what_divides(Sides& sides, Boundary& boundary, Trapezoidation& trapezoidation,
                       TrapezoidalGraph& graph, unsigned threads);

}  // namespace trapeze
