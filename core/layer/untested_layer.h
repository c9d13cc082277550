// A layer generalized without the topological consistency test (paper, section 4.2), to be compared
// with the one generalized with it.
#pragma once

#include <memory>

#include "core/layer/layer.h"

namespace trapeze {

/// The same polygons without the test, each by itself, and without a table of features. Takes about
/// as much time and memory as loading the layer did.
std::unique_ptr<const Layer> build_without_topology_test(const Layer& layer);

}  // namespace trapeze
