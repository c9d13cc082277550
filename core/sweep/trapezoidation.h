// Trapezoidation by plane sweep (paper, section 3.1), O(n log n), exact.
//
// The sweep visits the vertices in sweep order and keeps the edges that cross the sweep line from
// left to right, in a balanced tree and in a linked list. At a regular vertex one edge takes the
// place of another in O(1); the tree is searched only where edges begin. Every two edges that
// become neighbours are tested, so a crossing, an overlap or a vertex on an edge is always found
// (Shamos and Hoey): the sweep either succeeds or reports that the boundary is not noded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/graph/trapezoidal_graph.h"
#include "core/sweep/boundary.h"

namespace trapeze {

/// The face on the right of an edge, given the face on its left. Two edges that meet at a vertex
/// that no other edge has separate the same two faces.
using FaceBeyond = std::function<FaceId(EdgeId edge, FaceId left)>;

/// The sweep, with working memory for reuse. One call at a time.
class Trapezoidation {
 public:
  Trapezoidation();
  ~Trapezoidation();
  Trapezoidation(Trapezoidation&&) noexcept;
  Trapezoidation& operator=(Trapezoidation&&) noexcept;

  /// Makes `graph` the trapezoidal graph of the boundary, with even-odd faces; its corners are left
  /// empty (see BoundaryLoops). Returns false, leaving `graph` unspecified, if the boundary is not
  /// noded: two edges cross or overlap, or a vertex lies on an edge.
  bool build(const Boundary& boundary, TrapezoidalGraph& graph);

  /// The same with faces given by the caller. Left of all edges is kOutside. Faces are requested
  /// once the boundary is known to be noded, in sweep order of the edges' upper ends, from left to
  /// right. Runs on up to `threads` threads; the graph does not depend on their number.
  bool build(const Boundary& boundary, const FaceBeyond& face_beyond, TrapezoidalGraph& graph,
             unsigned threads = 1);

 private:
  class Slab;

  bool sweep(unsigned threads);
  void start(std::size_t guests);
  bool join_slabs();
  void join(const Slab& upper, const Slab& lower);
  void name_faces(const FaceBeyond& face_beyond);

  const Boundary* boundary_ = nullptr;
  TrapezoidalGraph* graph_ = nullptr;
  bool is_even_odd_ = false;
  std::vector<std::unique_ptr<Slab>> slabs_;
  std::size_t used_ = 0;               // of the slabs
  LargeArray<std::uint32_t> slot_of_;  // by edge, in the slab where it begins
  std::vector<NodeId> joined_;         // replaces a node that a slab began with
  std::vector<EdgeId> starting_;
};

}  // namespace trapeze
