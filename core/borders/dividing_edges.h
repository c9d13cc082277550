// Edges of a subdivision that have different faces on their two sides.
#pragma once

#include <utility>
#include <vector>

#include "core/graph/trapezoidal_graph.h"
#include "core/sweep/boundary.h"
#include "core/sweep/trapezoidation.h"

namespace trapeze {

/// The faces to the left and right of each edge.
using Sides = std::vector<std::pair<FaceId, FaceId>>;

/// `graph` is the graph of the boundary. Reduces the boundary and the sides to the edges with
/// different faces on their sides, and makes `graph` the graph of these. Returns false if there are
/// none. Runs on up to `threads` threads.
bool keep_what_divides(Sides& sides, Boundary& boundary, Trapezoidation& trapezoidation,
                       TrapezoidalGraph& graph, unsigned threads);

}  // namespace trapeze
