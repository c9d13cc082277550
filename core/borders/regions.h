// The regions of a graph: the connected components of its faces. A feature of several islands has
// several regions. So does the outside: each hole, and the unbounded region around everything.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/graph/trapezoidal_graph.h"
#include "core/grid/ids.h"

namespace trapeze {

using RegionId = Id<struct RegionTag>;

/// The regions of a graph in its present state.
struct Regions {
  explicit Regions(const TrapezoidalGraph& graph);

  Table<EdgeId, std::array<RegionId, 2>> beside;  // left and right of each edge, except the frame's
  Table<RegionId, double> area;  // cells squared; meaningless for the unbounded region
  Table<RegionId, FaceId> face;
  RegionId unbounded;  // at the frame
};

}  // namespace trapeze
