// Finds the simple loops of the boundary and stores them as the corners of a trapezoidal graph.
//
// Rings of the source that do not touch are such loops already. Where rings touch, the edges at the
// shared vertex are paired again so that each pair bounds one inside wedge. A loop that still
// returns to a vertex is cut there, so every loop visits a vertex at most once.
#pragma once

#include <cstdint>
#include <vector>

#include "core/graph/trapezoidal_graph.h"
#include "core/grid/rings.h"
#include "core/sweep/boundary.h"

namespace trapeze {

/// Holds working memory for reuse. One thread at a time.
class BoundaryLoops {
 public:
  /// Fills the corners of `graph` from rings that touch neither each other nor themselves.
  /// `boundary` was made from these rings. Corner i is the i-th point of the rings.
  void take_rings(const Rings& rings, const Boundary& boundary, TrapezoidalGraph& graph);

  /// Fills the corners of `graph` from its edges and faces alone. Edge i leaves corner i.
  void trace(const Boundary& boundary, TrapezoidalGraph& graph);

 private:
  EdgeId partner(VertexId v, EdgeId e) const;
  void pair_edges(const Boundary& boundary, const TrapezoidalGraph& graph, VertexId v);
  void cut_into_simple_loops(TrapezoidalGraph& graph);
  static void close_loop(TrapezoidalGraph& graph, const CornerId* begin, const CornerId* end);

  std::vector<EdgeId> around_;
  std::vector<EdgeId> partner_;  // by 2 * edge + (0 at the upper end, 1 at the lower)
  const Boundary* boundary_ = nullptr;
  std::vector<std::uint32_t> position_;  // of a vertex on the stack + 1
  std::vector<CornerId> loop_;
  std::vector<CornerId> stack_;
  std::vector<bool> seen_;
};

}  // namespace trapeze
