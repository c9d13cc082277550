// Trapezoidation by plane sweep (paper, section 3.1), O(n log n), exact.
//
// The sweep goes through the vertices in sweep order and keeps the edges that cross the sweep line
// from left to right, in a balanced tree and in a linked list. At a regular vertex one edge takes
// the place of another in O(1); only where edges begin is the tree searched. Every two edges
// that become neighbours are tested, so a crossing, an overlap or a vertex on an edge is always
// found (Shamos and Hoey): the sweep either succeeds or reports that the boundary is not noded.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/graph/trapezoidal_graph.h"
#include "core/sweep/boundary.h"
#include "core/sweep/sweep_order.h"

namespace trapeze {

/// The face on the right of an edge, given the face on its left. Two edges that meet at a vertex
/// that no other edge has separate the same two faces.
using FaceBeyond = std::function<FaceId(EdgeId edge, FaceId left)>;

/// The sweep, with working memory for reuse; one thread at a time.
class Trapezoidation {
 public:
  /// Makes `graph` the trapezoidal graph of the boundary, with even-odd faces; its corners are left
  /// empty (see BoundaryLoops). Returns false, leaving `graph` unspecified, if the boundary is not
  /// noded: two edges cross or overlap, or a vertex lies on an edge.
  bool build(const Boundary& boundary, TrapezoidalGraph& graph);

  /// The same with faces given by the caller; what lies to the left of all edges is kOutside.
  bool build(const Boundary& boundary, const FaceBeyond& face_beyond, TrapezoidalGraph& graph);

 private:
  // An edge that crosses the sweep line, and the open node to its right.
  struct Crossing {
    EdgeId edge;
    NodeId right;  // between this edge and the next
  };
  using Status = SweepOrder<Crossing>;
  using Slot = Status::Slot;

  bool sweep();
  void start();
  bool sweep_vertex(VertexId v);
  bool sweep_regular(VertexId v, EdgeId ending, EdgeId starting);
  bool sweep_general(VertexId v);
  bool sort_starting_edges(VertexId v);
  /// The first of the slots, which must be neighbours, whose edges end at v; none if they are not.
  Slot first_of_run(VertexId v, std::size_t count) const;

  /// Closes the node right of `slot` at v and returns it.
  NodeId close(Slot slot, VertexId v);
  /// Opens a node right of `slot` at v.
  NodeId open(Slot slot, VertexId v);
  void link(Side side, NodeId upper, NodeId lower);

  /// The slot of the edge directly left of v; none if v lies on an edge.
  Slot locate(VertexId v) const;
  /// The neighbours `left` and `right` do not meet below the sweep line, but for a common end.
  bool is_apart(Slot left, Slot right) const;

  const Boundary* boundary_ = nullptr;
  const FaceBeyond* face_beyond_ = nullptr;  // none: even-odd
  TrapezoidalGraph* graph_ = nullptr;
  Status status_;              // its ends are the edges of the frame
  std::vector<Slot> slot_of_;  // by edge
  // At the current vertex: edges that end there and that start there, from left to right.
  std::vector<EdgeId> ending_;
  std::vector<EdgeId> starting_;
};

}  // namespace trapeze
