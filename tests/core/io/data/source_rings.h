// The polygons of a file as rings, before any graph is built, and the tolerances of zooms.
#pragma once

#include <string>
#include <vector>

#include "core/grid/rings.h"

namespace trapeze::testing {

/// The rings of each feature that has polygons. A feature that cannot be read fails the test.
std::vector<Rings> rings_of_source(const std::string& path);

/// The default simplification tolerance for tiles of this zoom, in cells: 0.25 of their 256 pixels
/// a side, rounded to the nearest level.
double epsilon_of_zoom(int zoom);

}  // namespace trapeze::testing
