// How far along its outline every edge of a polygon lies: what dashes need to run on from edge to
// edge.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// An edge as it is met on the way around its loop.
struct LoopEdge {
  std::uint32_t edge = 0;
  bool leads_up = false;  // from its lower vertex to its upper one
  double along = 0;       // cells from where the loop begins to where the edge does
};

/// Walks the loops that the edges form: each begins at its edge of the smallest number. `edges` are
/// different; the answer has one item for each, in ascending order of edges. Depends on nothing but
/// the set of edges. Edges that form no loop are walked as far as they lead.
std::vector<LoopEdge> measure_loops(const MeshView& mesh, std::vector<std::uint32_t> edges);

}  // namespace trapeze
