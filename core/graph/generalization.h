// The generalization operators (paper, section 3.2). Removing one vertex changes only the
// trapezoids next to it.
//
// All of the paper's operators on inside trapezoids occur here; the outside is meshed as well:
//   merging       two trapezoids, one above the other, become one where the horizontal line between
//                 them disappears, or two, side by side, where the edge between them disappears;
//   elimination   the trapezoid in the tip of an extremum, or inside the last triangle, disappears;
//   degeneration  a trapezoid whose top or bottom had two corners becomes a triangle, when the edge
//                 that ended beside its tip now ends at it;
//   adjustment    a trapezoid keeps its top and bottom and gets another edge or another vertex.
//
// All changes go through the edit log. Whether a vertex may be removed is decided first (see
// topological_consistency.h).
#pragma once

#include "core/graph/edit_log.h"
#include "core/graph/topological_consistency.h"
#include "core/graph/trapezoidal_graph.h"

namespace trapeze {

class Generalization {
 public:
  /// Both must outlive this object. `log` is the log of `graph`.
  Generalization(const TrapezoidalGraph& graph, EditLog& log) : g_(graph), log_(log) {}

  /// Removes `corner` as one edit. `removal` is the result of decide_removal() for the present
  /// graph and is not `blocked`.
  void remove(CornerId corner, Removal removal);

  /// Removes an edge as a part of the current edit: the two lists of nodes along it become one. No
  /// other edge changes, so no crossing can arise. Corners are left to the caller. Precondition:
  /// the faces on both sides of the edge are the same.
  void remove_edge(EdgeId edge);

 private:
  void remove_regular(CornerId corner);   // vertical generalization
  void remove_extremum(CornerId corner);  // horizontal generalization
  void remove_loop(CornerId corner);

  EdgeId join_edges(EdgeId upper, EdgeId lower);
  bool upper_list_is_shorter(EdgeId upper, EdgeId lower) const;
  void merge_stacked(NodeId keep, NodeId gone, Direction d);

  struct Zipped {
    NodeId first;  // the merged node at the start
    NodeId last;   // the merged node at the stop
    NodeId
        rest;  // the node that continues beyond the stop on the far side; none if both sides stop
  };
  Zipped zip(NodeId near, NodeId far, Side near_side, Direction d, VertexId stop);
  void insert_before(NodeId n, NodeId next, Side side, Direction d);
  void drop_beside(NodeId keep, NodeId gone, Side side, Direction d);

  NodeId& extreme_of(EdgeId e, Side side, Direction d) { return log_.edit(e).extreme[side][d]; }
  void set_link(NodeId n, Side side, Direction d, NodeId next) {
    log_.edit(n).link[side][d] = next;
  }
  void kill(NodeId n) { log_.edit(n) = Node{}; }
  void kill(EdgeId e) { log_.edit(e) = Edge{}; }
  void unlink(CornerId corner, EdgeId joined);

  const TrapezoidalGraph& g_;
  EditLog& log_;
};

}  // namespace trapeze
