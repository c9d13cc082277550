// Closes gaps and overlaps between polygons that were drawn each by itself, so that their borders
// run beside each other and not in one line.
//
// First vertices: one goes to the nearest one of another polygon. Then edges: one is led through
// the vertices of other polygons beside it. What two polygons have in common afterwards is noded as
// in any coverage; places between borders that could not be brought together are left, and are
// filled if they are narrow enough (see CoverageBuilder).
#pragma once

#include <cstddef>
#include <span>

#include "core/grid/rings.h"

namespace trapeze {

/// What gaps may be closed up to, in metres.
constexpr double kWidestGap = 1000;

/// What has been done.
struct GapClosing {
  std::size_t moved = 0;  // vertices that went to one of another feature
  std::size_t led = 0;    // vertices through which edges of other features were led
};

/// Brings borders of different features together that are no farther apart than `metres` on the
/// ground, in (0, kWidestGap]. A vertex moves by no more than that and goes nowhere if its features
/// have a vertex there already, so that the shape of a single one is not simplified; the edges
/// beside it bend by as much again. Rings are clean before and after (see clean_rings.h); features
/// that were narrower than a gap may have none left. The result depends on the features and their
/// order only.
GapClosing close_gaps(std::span<Rings* const> features, double metres);

}  // namespace trapeze
