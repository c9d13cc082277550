// The rings of the polygons of a file, one set per feature, for benchmarks of the core.
#pragma once

#include <string>
#include <vector>

#include "core/grid/rings.h"

namespace trapeze {

/// Projected, clipped and snapped as for a layer. Throws std::runtime_error if the source cannot be
/// opened.
std::vector<Rings> read_source_rings(const std::string& path);

}  // namespace trapeze
