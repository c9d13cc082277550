// The rules by which a graph is generalized.
#pragma once

#include "core/adapt/vertex_weight.h"
#include "core/graph/topology.h"

namespace trapeze {

struct GeneralizationOptions {
  WeightRule weights = WeightRule::douglas_peucker;
  Topology topology = Topology::strict;

  friend bool operator==(const GeneralizationOptions&, const GeneralizationOptions&) = default;
};

}  // namespace trapeze
