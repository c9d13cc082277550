// Closes narrow gaps and overlaps between polygons whose borders were digitized separately, so that
// they run beside each other instead of coinciding.
//
// First, vertices are moved to the nearest vertex of another polygon. Then, edges are routed
// through the vertices of other polygons beside them. The result is noded as any coverage is; gaps
// between borders that could not be brought together remain, and are filled if they are narrow
// enough (see CoverageBuilder).
#pragma once

#include <cstddef>
#include <span>

#include "core/grid/rings.h"

namespace trapeze {

/// The greatest width of a gap that may be closed, in metres.
constexpr double kWidestGap = 1000;

/// What close_gaps() has done.
struct GapClosing {
  std::size_t moved = 0;  // vertices moved to a vertex of another feature
  std::size_t led = 0;    // vertices through which edges of other features were routed
};

/// Makes borders of different features coincide where they are at most `metres` apart on the
/// ground; 0 < metres <= kWidestGap. A vertex moves by no more than that, and not to a place where
/// one of its features already has a vertex, so that the shape of a feature is not simplified; the
/// edges beside it may bend by as much again. Rings are clean before and after (see clean_rings.h);
/// features that were narrower than a gap may have none left. The result depends on the features
/// and their order only.
GapClosing close_gaps(std::span<Rings* const> features, double metres);

}  // namespace trapeze
