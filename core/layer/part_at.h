// The part of a feature under a point: for a country with islands, the island.
#pragma once

#include "core/grid/grid.h"
#include "core/grid/rings.h"

namespace trapeze {

/// The box of the outer ring of the part that contains the point. If none does (the point was drawn
/// there, simplified), the box of the part whose boundary is nearest. Rings are those of one
/// feature, nested by even-odd and without crossings. Empty if there are no rings.
Box part_at(const Rings& rings, Point point);

}  // namespace trapeze
