// What lies beyond a view need not be drawn as it is: only what is in the view counts.
#pragma once

#include <cstdint>

#include "core/grid/grid.h"
#include "core/grid/rings.h"

namespace trapeze::experiment {

/// Appends rings `first` .. `last` - 1 with short cuts: of vertices in a row that all lie left,
/// right, above or below of `view`, the first and the last are left. By even-odd the same points of
/// the view are inside as before. Beyond the view edges may come to cross; rings with nothing
/// in the view may go.
void append_with_short_cuts(const Rings& rings, std::uint32_t first, std::uint32_t last,
                            const Box& view, Rings& shortened);

}  // namespace trapeze::experiment
