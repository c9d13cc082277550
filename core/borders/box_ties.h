// Groups nearby items by their bounding boxes.
#pragma once

#include <cstdint>
#include <span>

#include "core/grid/disjoint_sets.h"
#include "core/grid/grid.h"

namespace trapeze {

/// Unites the owners of boxes that intersect. If there are so many intersections that examining all
/// of them would take seconds, some owners whose boxes do not intersect are united as well.
void tie_meeting(std::span<const Box> boxes, std::span<const std::uint32_t> owners,
                 DisjointSets& sets);

}  // namespace trapeze
