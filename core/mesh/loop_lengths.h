// The distance along the outline at which each edge of a polygon begins, so that a dash pattern can
// continue from edge to edge.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// An edge of a loop, in the direction in which the loop is walked.
struct LoopEdge {
  std::uint32_t edge = 0;
  bool leads_up = false;  // from its lower vertex to its upper one
  double along = 0;       // length of the loop up to the beginning of the edge, in cells
};

/// Walks the loops that the edges form, each from its edge of the smallest index. `edges` has no
/// duplicates; the result has one item for each edge, in ascending order of edges, and depends only
/// on the set of edges. Edges that do not form a loop are walked to their end.
std::vector<LoopEdge> measure_loops(const MeshView& mesh, std::vector<std::uint32_t> edges);

}  // namespace trapeze
