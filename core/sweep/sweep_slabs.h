// Cuts a plane sweep into slabs that can be swept in parallel.
//
// At a cut, the sweep line lies just above a row of vertices, so that no horizontal edge crosses
// it. The edges that cross it are known without sweeping. Each slab is swept by itself; trapezoids
// still open at its end are then continued by those with which the next slab began.
#pragma once

#include <cstddef>
#include <vector>

#include "core/sweep/boundary.h"

namespace trapeze {

/// The first vertex of each slab, which is the first one of its row, and finally one past the last
/// vertex. There are at most `slabs` slabs of about equal size, and none with only few vertices.
/// The first slab begins with vertex 1.
std::vector<VertexId> cut_into_slabs(const Boundary& boundary, std::size_t slabs);

/// The edges that cross the sweep line just above `first`, the first vertex of a row, from left to
/// right; coinciding ones by number. They may cross each other.
std::vector<EdgeId> edges_across(const Boundary& boundary, VertexId first);

}  // namespace trapeze
