// How a layer is built.
#pragma once

#include "core/adapt/adaptable_graph.h"
#include "core/borders/coverage_groups.h"

namespace trapeze {

/// How each graph is generalized, and which features live in one.
struct LayerOptions : GeneralizationOptions {
  CoverageMode coverage = kUsualCoverage;
  double close_gaps = 0;  // metres on the ground, up to kWidestGap; where there are coverages

  friend bool operator==(const LayerOptions&, const LayerOptions&) = default;
};

}  // namespace trapeze
