// Generated maps.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/experiment/map_data.h"
#include "core/grid/grid.h"

namespace trapeze::experiment {

/// All of the grid.
inline constexpr Box kEverything{kGridMin, kGridMin, kGridMax, kGridMax};

/// The polygons of random_shape(0) to random_shape(count - 1), each on its own.
std::vector<PolygonSet> random_polygon_sets(unsigned count);

/// A town with that number of buildings, beside a coast: two layers.
Map sample_map(unsigned buildings);

}  // namespace trapeze::experiment
