// The connected pieces of the faces of a graph: a feature of several islands has several, and so
// has the outside, with a hole each and what surrounds everything.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/graph/trapezoidal_graph.h"
#include "core/grid/ids.h"

namespace trapeze {

using RegionId = Id<struct RegionTag>;

/// The regions of a graph as it is.
struct Regions {
  explicit Regions(const TrapezoidalGraph& graph);

  Table<EdgeId, std::array<RegionId, 2>> beside;  // left and right of each edge but the frame's
  Table<RegionId, double> area;                   // cells squared; that at the frame has none
  Table<RegionId, FaceId> face;
  RegionId unbounded;  // at the frame
};

}  // namespace trapeze
