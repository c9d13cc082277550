// A layer generalized without the topological consistency test (paper, section 4.2), beside the one
// that was generalized with it.
#pragma once

#include <memory>

#include "core/layer/layer.h"

namespace trapeze {

/// The same polygons without the test, and each by itself; without a table of features. Takes about
/// as long and as much memory as loading the layer did.
std::unique_ptr<const Layer> build_without_topology_test(const Layer& layer);

}  // namespace trapeze
