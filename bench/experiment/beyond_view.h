// Simplifies the parts of polygons outside a view, which need not be drawn accurately.
#pragma once

#include <cstdint>

#include "core/grid/grid.h"
#include "core/grid/rings.h"

namespace trapeze::experiment {

/// Appends rings `first` .. `last` - 1 with short cuts: of consecutive vertices that are all left
/// of, right of, above or below `view`, only the first and the last remain. By the even-odd rule,
/// the same points of the view are inside as before. Outside the view, edges may cross; rings with
/// no part in the view may be removed.
void append_with_short_cuts(const Rings& rings, std::uint32_t first, std::uint32_t last,
                            const Box& view, Rings& shortened);

}  // namespace trapeze::experiment
