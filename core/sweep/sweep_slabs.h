// Cuts a plane sweep into slabs that can be swept at the same time.
//
// The sweep line lies just above a row of vertices there, so that no horizontal edge crosses it.
// What crosses it is known without sweeping; where a slab has been swept as if alone, what is still
// open at its end is continued by what the next one began with.
#pragma once

#include <cstddef>
#include <vector>

#include "core/sweep/boundary.h"

namespace trapeze {

/// The first vertex of each slab, each the first one of its row, and one after the last vertex: of
/// at most so many slabs about equally large, and none of only few vertices. The first slab begins
/// with vertex 1.
std::vector<VertexId> cut_into_slabs(const Boundary& boundary, std::size_t slabs);

/// The edges that cross the sweep line just above `first`, the first vertex of a row, from left to
/// right; those that coincide by number. They may cross each other.
std::vector<EdgeId> edges_across(const Boundary& boundary, VertexId first);

}  // namespace trapeze
