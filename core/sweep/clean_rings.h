// Removes from rings the parts that have no area after snapping to the grid: duplicate points,
// spikes and collapsed rings.
#pragma once

#include <cstddef>

#include "core/grid/rings.h"

namespace trapeze {

/// Drops consecutive duplicates (including a repeated first point) and spikes (where a boundary
/// runs back over itself), then rings of fewer than three points. The set of points inside by
/// even-odd does not change. Returns the number of rings dropped.
std::size_t clean_rings(Rings& rings);

}  // namespace trapeze
