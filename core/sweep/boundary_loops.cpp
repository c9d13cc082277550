#include "core/sweep/boundary_loops.h"

#include <algorithm>

#include "core/sweep/boundary_walk.h"

namespace trapeze {

void BoundaryLoops::take_rings(const Rings& rings, const Boundary& boundary,
                               TrapezoidalGraph& graph) {
  auto& corners = graph.corners_;
  corners.resize(rings.points.size());
  std::size_t begin = 0;
  for (const std::uint32_t end : rings.ends) {
    for (std::size_t i = begin; i < end; ++i) {
      corners[CornerId(i)] =
          Corner{boundary.ring_vertex[i], EdgeId(i), CornerId(i == begin ? end - 1 : i - 1),
                 CornerId(i + 1 < end ? i + 1 : begin)};
    }
    begin = end;
  }
}

void BoundaryLoops::trace(const Boundary& boundary, TrapezoidalGraph& graph) {
  boundary_ = &boundary;
  const std::size_t count = boundary.edges.size();
  partner_.assign(2 * count, EdgeId());
  for (std::size_t v = 1; v + 1 < boundary.vertices.size(); ++v) {
    pair_edges(boundary, graph, VertexId(v));
  }
  graph.corners_.assign(count, Corner{});
  for (std::size_t e = 0; e < count; ++e) {
    const EdgeId first(e);
    if (!graph.corners_[CornerId(e)].vertex.is_none()) continue;
    walk_boundary(
        boundary, boundary.edges[first].upper, first,
        [this](VertexId v, EdgeId at) { return partner(v, at); }, graph.corners_);
  }
  if (boundary.has_touches) cut_into_simple_loops(graph);
}

// The edges around v in circular order: those that start at v from left to right, then those that
// end at v from right to left. Two successive edges with inside between them are paired.
void BoundaryLoops::pair_edges(const Boundary& boundary, const TrapezoidalGraph& graph,
                               VertexId v) {
  const auto edges = boundary.edges_at(v);
  const auto set_partner = [&](EdgeId a, EdgeId b) {
    partner_[2 * a.value + (boundary.edges[a].lower == v)] = b;
    partner_[2 * b.value + (boundary.edges[b].lower == v)] = a;
  };
  if (edges.size() == 2) return set_partner(edges[0], edges[1]);

  around_.assign(edges.begin(), edges.end());
  const auto middle = std::partition(around_.begin(), around_.end(),
                                     [&](EdgeId e) { return boundary.edges[e].upper == v; });
  const Point p = boundary.vertices[v];
  // Negative orientation is to the right of an edge that goes down from v, and to the left of one
  // that comes from above: the same comparison yields the same direction of rotation around v in
  // both halves.
  std::sort(around_.begin(), middle, [&](EdgeId a, EdgeId b) {
    return orientation(p, boundary.vertices[boundary.edges[a].lower],
                       boundary.vertices[boundary.edges[b].lower]) < 0;
  });
  std::sort(middle, around_.end(), [&](EdgeId a, EdgeId b) {
    return orientation(p, boundary.vertices[boundary.edges[a].upper],
                       boundary.vertices[boundary.edges[b].upper]) < 0;
  });
  for (std::size_t i = 0; i < around_.size(); ++i) {
    const EdgeId e = around_[i];
    // The area that follows e in circular order is on the right of an edge below v and on the left
    // of one above.
    const bool below = boundary.edges[e].upper == v;
    const Side following = below ? kRight : kLeft;
    if (graph.edge(e).face[following] != kOutside)
      set_partner(e, around_[(i + 1) % around_.size()]);
  }
}

EdgeId BoundaryLoops::partner(VertexId v, EdgeId e) const {
  return partner_[2 * e.value + (boundary_->edges[e].lower == v)];
}

void BoundaryLoops::cut_into_simple_loops(TrapezoidalGraph& graph) {
  auto& corners = graph.corners_;
  position_.assign(graph.vertices_.size(), 0);
  seen_.assign(corners.size(), false);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (seen_[i]) continue;
    loop_.clear();
    for (CornerId c(i); !seen_[c.value]; c = corners[c].next) {
      seen_[c.value] = true;
      loop_.push_back(c);
    }
    stack_.clear();
    for (const CornerId c : loop_) {
      const std::uint32_t at = position_[corners[c].vertex.value];
      if (at != 0) {
        // The part from the earlier visit to here is a loop of its own.
        for (std::size_t k = at - 1; k < stack_.size(); ++k) {
          position_[corners[stack_[k]].vertex.value] = 0;
        }
        close_loop(graph, stack_.data() + at - 1, stack_.data() + stack_.size());
        stack_.resize(at - 1);
      }
      stack_.push_back(c);
      position_[corners[c].vertex.value] = static_cast<std::uint32_t>(stack_.size());
    }
    for (const CornerId c : stack_) position_[corners[c].vertex.value] = 0;
    close_loop(graph, stack_.data(), stack_.data() + stack_.size());
  }
}

void BoundaryLoops::close_loop(TrapezoidalGraph& graph, const CornerId* begin,
                               const CornerId* end) {
  for (const CornerId* c = begin; c != end; ++c) {
    graph.corners_[*c].next = c + 1 != end ? c[1] : *begin;
    graph.corners_[*c].prev = c != begin ? c[-1] : end[-1];
  }
}

}  // namespace trapeze
