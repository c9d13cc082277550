// Finds where segments meet, by plane sweep (Bentley and Ottmann 1979), O((n + k) log n) for k
// meetings, wherever the segments lie.
//
// The sweep stops at the ends of segments only, in sweep order. What crosses between two stops is
// brought into its new order by swapping neighbours, each pair at the first stop after its
// crossing. So crossings are never compared with each other, but with grid points, which is exact
// in 128 bits; and the order in which crossings between the same two stops are dealt with does not
// matter.
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

/// Where segments meet other than at a common end: the crossings of their interiors, each rounded
/// to the nearest cell (halves go down and to the right), and ends of some on the interiors of
/// others. In sweep order, each once. None if there are more than `most` meetings, each crossing of
/// two segments and each segment on which an end of another lies being one.
std::optional<std::vector<Point>> find_meetings(const std::vector<Segment>& segments,
                                                std::size_t most);

/// The same for the edges of a boundary, on up to `threads` threads; the result does not depend on
/// their number.
std::optional<std::vector<Point>> find_meetings(const Boundary& boundary, std::size_t most,
                                                unsigned threads = 1);

}  // namespace trapeze
