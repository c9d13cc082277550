// Layers that cannot be served without the topological consistency test.
#pragma once

#include <string>

#include "server/config/config.h"

namespace trapeze {

/// A message if a layer in parts would have to be built for topology=fast; empty if not.
std::string find_topology_problem(const LayerConfig& layer);

}  // namespace trapeze
