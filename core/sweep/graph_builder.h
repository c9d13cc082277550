// Builds the trapezoidal graph of one feature from its rings, which may be invalid in any way.
#pragma once

#include <cstddef>
#include <string>

#include "core/graph/trapezoidal_graph.h"
#include "core/grid/rings.h"
#include "core/sweep/boundary.h"
#include "core/sweep/boundary_loops.h"
#include "core/sweep/trapezoidation.h"

namespace trapeze {

/// What happened to the rings of one feature while its graph was built.
struct BuildOutcome {
  bool built = false;               // false: nothing left to draw, or failed
  bool noded = false;               // rings crossed, touched or overlapped and were noded
  std::size_t rings = 0;            // rings of the feature as given
  std::size_t collapsed_rings = 0;  // rings without area after snapping
  std::size_t vertices = 0;         // vertices of the finished polygon
  std::string failure;              // why it could not be built, empty otherwise
};

/// Holds working memory for reuse. One thread at a time.
class GraphBuilder {
 public:
  /// Makes `graph` the graph of the rings by even-odd. Cleans `rings` in place: drops duplicates,
  /// spikes and collapsed rings. Nodes crossings, touches and overlaps on the grid unless there are
  /// too many (see most_meetings() in noding.h). Never throws for bad geometry: `graph` is
  /// meaningful only if `built` is true in the outcome. Runs on up to `threads` threads; the graph
  /// does not depend on their number.
  BuildOutcome build(Rings& rings, TrapezoidalGraph& graph, unsigned threads = 1);

 private:
  bool sweep(TrapezoidalGraph& graph, unsigned threads);
  bool build_noded(const Rings& rings, TrapezoidalGraph& graph, unsigned threads,
                   BuildOutcome& outcome);

  Boundary boundary_;
  Trapezoidation trapezoidation_;
  BoundaryLoops loops_;
};

}  // namespace trapeze
