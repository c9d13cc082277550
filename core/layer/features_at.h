// The features under a point of the map, as drawn at a tolerance.
#pragma once

#include <cstdint>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/tolerance.h"
#include "core/layer/layer.h"

namespace trapeze {

/// Whether the trapezoid contains the point. Exact. Points on the left side and on the top belong
/// to it, those on the right side and on the bottom do not, so each point of an area tiled by
/// trapezoids lies in exactly one.
bool holds_point(const MeshView& mesh, const MeshTrapezoid& trapezoid, Point point);

/// The rows of the features whose polygons contain the point at the level, in ascending order, each
/// once. Polygons that are dust at the level contain nothing.
std::vector<std::uint32_t> features_at(const Layer& layer, Point point, Level level);

}  // namespace trapeze
