// Walks the edges of a graph of several polygons into arcs, and writes them down as corners.
//
// An arc is a run of edges between the same two regions. It ends at junctions, where three or more
// regions meet; where an arc only passes through a vertex that others visit as well, as that of a
// lake that touches another one in the middle of a country, it goes on. So a vertex can be the end
// of some arcs and be passed through by others.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/borders/regions.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/grid/grid.h"
#include "core/sweep/boundary.h"

namespace trapeze {

/// An edge as it leaves a vertex.
struct Spoke {
  EdgeId edge;
  Point far;           // its other end
  bool goes_down;      // the vertex is its upper end
  RegionId before;     // the regions beside it, counterclockwise around the vertex:
  RegionId following;  // `following` of each spoke is `before` of the next
};

/// The spoke of an edge that begins or ends at `v`.
Spoke spoke_of(const TrapezoidalGraph& graph, VertexId v, EdgeId e, RegionId left, RegionId right);

/// Puts the spokes of one vertex in order around it.
void sort_around(Point centre, std::vector<Spoke>& spokes);

/// Which of the spokes, in order around their vertex, belong to arcs that go on there: pairs of
/// edges that bound a wedge from both sides of which lies the same region. No two pairs cross.
std::vector<std::pair<EdgeId, EdgeId>> pair_spokes(const std::vector<Spoke>& spokes);

/// Reusable memory; one a thread.
class BorderArcs {
 public:
  /// Fills the corners of `graph` from its edges and regions; edge i leaves corner i. Its faces are
  /// those of `faces` polygons.
  void trace(const Boundary& boundary, FaceId faces, const Regions& regions,
             TrapezoidalGraph& graph);

  /// The faces beside edge i are sides[i] from then on, left and right.
  static void name_faces(std::span<const std::pair<FaceId, FaceId>> sides, TrapezoidalGraph& graph);

 private:
  EdgeId& partner(VertexId v, EdgeId e);
  void pair_edges(VertexId v, const Regions& regions, const TrapezoidalGraph& graph);
  void walk(VertexId start, EdgeId first, TrapezoidalGraph& graph);

  const Boundary* boundary_ = nullptr;
  std::vector<EdgeId> partner_;  // by 2 * edge + (0 at the upper end, 1 at the lower)
  std::vector<Spoke> spokes_;
};

}  // namespace trapeze
