// Finds the arcs of a coverage and stores them as the corners of its graph.
//
// An arc is a run of edges between the same two regions. It ends at junctions, where three or more
// regions meet. Where two pieces of boundary merely touch at a vertex, as two lakes in the middle
// of a country may, the arcs continue. So a vertex can be the end of some arcs and in the middle of
// others.
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

/// An edge, seen from one of its ends.
struct Spoke {
  EdgeId edge;
  Point far;           // its other end
  bool goes_down;      // the vertex is its upper end
  RegionId before;     // the regions beside it, counterclockwise around the vertex:
  RegionId following;  // `following` of each spoke is `before` of the next
};

/// The spoke of an edge that begins or ends at `v`.
Spoke spoke_of(const TrapezoidalGraph& graph, VertexId v, EdgeId e, RegionId left, RegionId right);

/// Sorts the spokes of one vertex counterclockwise around it.
void sort_around(Point centre, std::vector<Spoke>& spokes);

/// The pairs of edges by which arcs continue through a vertex: two edges that bound a wedge and
/// have the same region beyond both. The spokes are in order around the vertex. No two pairs cross.
std::vector<std::pair<EdgeId, EdgeId>> pair_spokes(const std::vector<Spoke>& spokes);

/// Holds working memory for reuse. One thread at a time.
class BorderArcs {
 public:
  /// Fills the corners of `graph` from its edges and regions. Edge i leaves corner i. The graph has
  /// the faces of `faces` polygons.
  void trace(const Boundary& boundary, FaceId faces, const Regions& regions,
             TrapezoidalGraph& graph);

  /// Sets the faces to the left and right of each edge i to sides[i].
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
