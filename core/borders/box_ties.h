// Ties what lies near each other, as far as boxes tell.
#pragma once

#include <cstdint>
#include <span>

#include "core/grid/disjoint_sets.h"
#include "core/grid/grid.h"

namespace trapeze {

/// Ties the owners of boxes that meet. Where so many meet that looking at all of them would take
/// seconds, some that do not meet are tied as well.
void tie_meeting(std::span<const Box> boxes, std::span<const std::uint32_t> owners,
                 DisjointSets& sets);

}  // namespace trapeze
