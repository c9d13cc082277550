// The topological consistency test (paper, section 3.3): decides whether a vertex may be removed.
// Exact and local.
//
// Removing a vertex V between A and B replaces the boundary A V B by A B. No edge is crossed, and
// no part of the boundary changes sides, if and only if the closed triangle A V B contains no other
// vertex. If it contains one, a trapezoid along AV or VB on the triangle's side has such a vertex
// at its top or bottom: the horizontal line from the vertex nearest to AV or VB reaches it without
// meeting another edge. So only those trapezoids are examined (the paper's minimal surrounding
// trapezoid set).
#pragma once

#include <cstdint>

#include "core/graph/topology.h"
#include "core/graph/trapezoidal_graph.h"

namespace trapeze {

/// The kind of a removal.
enum class Removal : std::uint8_t {
  blocked,
  regular,   // A and B on different sides of V in sweep order: vertical generalization
  extremum,  // A and B on the same side of V: horizontal generalization
  loop,      // the loop is a triangle and is removed as a whole
  region,    // no corner: a region between junctions becomes part of a neighbour
};

struct Decision {
  Removal removal = Removal::blocked;
  /// If blocked: the vertex whose removal, from any loop, may unblock the corner.
  VertexId blocker;
  std::uint32_t walked = 0;  // trapezoids examined
};

/// Decides whether and how `corner` may be removed. Precondition: it is alive.
Decision decide_removal(const TrapezoidalGraph& graph, CornerId corner, Topology topology);

/// The edges from an extremum V to its nearer and its farther neighbour in sweep order, and these
/// neighbours. Precondition: both neighbours of V lie above it, or both below.
struct Extremum {
  Direction away = kDown;  // from V towards its neighbours
  EdgeId near_edge;
  EdgeId far_edge;
  VertexId near_vertex;
  VertexId far_vertex;
};
Extremum extremum_at(const TrapezoidalGraph& graph, CornerId corner);

/// A triangular loop: its vertices from top to bottom and its edges; the long edge joins top and
/// bottom, and the middle vertex lies on `side` of it.
struct TriangleLoop {
  CornerId top, middle, bottom;
  EdgeId upper_edge, lower_edge, long_edge;
  Side side = kLeft;
};
TriangleLoop triangle_loop_at(const TrapezoidalGraph& graph, CornerId corner);

/// The edges of a regular corner: the one that ends there and the one that starts there.
struct Passage {
  EdgeId upper_edge;
  EdgeId lower_edge;
};
Passage passage_at(const TrapezoidalGraph& graph, CornerId corner);

}  // namespace trapeze
