// The polygons of a file as rings, before any graph is made of them, and the tolerances of zooms.
#pragma once

#include <string>
#include <vector>

#include "core/grid/rings.h"

namespace trapeze::testing {

/// Of each feature that has polygons. A feature that cannot be read fails the test.
std::vector<Rings> rings_of_source(const std::string& path);

/// What tiles of this zoom are simplified with if nobody says otherwise, in cells: 0.25 of their
/// 256 pixels a side, as the nearest level has it.
double epsilon_of_zoom(int zoom);

}  // namespace trapeze::testing
