// In-memory layers to request: as small as possible, but with every kind of content.
#pragma once

#include <memory>

#include "server/data/dataset.h"

namespace trapeze::fuzzing {

/// "land": twelve polygons from a few cells to half of the world, some with a hole, with the
/// attributes "name" (text), "rank" (integer, sometimes null) and "size" (real). "water": two
/// polygons without attributes, drawn at the zooms 1 to 6, with a locked "stroke".
std::shared_ptr<const Dataset> sample_layers();

}  // namespace trapeze::fuzzing
