// Finds where segments meet, by plane sweep (Bentley and Ottmann 1979), in O((n + k) log n) for k
// meetings, wherever the segments lie.
//
// The sweep stops only at the ends of segments, in sweep order. Segments that cross between two
// stops are brought into their new order by swapping neighbours, each pair at the first stop after
// its crossing. So crossings are never compared with each other, only with grid points, which is
// exact in 128 bits, and the order in which crossings between the same two stops are handled does
// not matter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/grid/grid.h"
#include "core/sweep/boundary.h"
#include "core/sweep/segment.h"
#include "core/sweep/sweep_order.h"

namespace trapeze {

/// Returns where segments meet other than at a common end: the crossings of their interiors, each
/// rounded to the nearest cell (halves go down and to the right), and ends of segments on the
/// interiors of others. In sweep order, each once. None if there are more than `most` meetings;
/// each crossing of two segments counts as one, and so does each segment on which an end of another
/// lies.
std::optional<std::vector<Point>> find_meetings(const std::vector<Segment>& segments,
                                                std::size_t most);

/// The same for the edges of a boundary, on up to `threads` threads; the result does not depend on
/// their number.
std::optional<std::vector<Point>> find_meetings(const Boundary& boundary, std::size_t most,
                                                unsigned threads = 1);

}  // namespace trapeze
