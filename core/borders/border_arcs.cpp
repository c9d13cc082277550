#include "core/borders/border_arcs.h"

#include <algorithm>
#include <span>

#include "core/sweep/boundary_walk.h"

namespace trapeze {

Spoke spoke_of(const TrapezoidalGraph& graph, VertexId v, EdgeId e, RegionId left, RegionId right) {
  const Edge& edge = graph.edge(e);
  const bool goes_down = edge.end[kUp] == v;
  const Point far = graph.point(edge.end[goes_down ? kDown : kUp]);
  return goes_down ? Spoke{e, far, true, left, right} : Spoke{e, far, false, right, left};
}

// Those that go down from left to right, then those that go up from right to left. Negative
// orientation is to the right of an edge that goes down from the centre, and to the left of one
// that comes from above: the same comparison yields the same direction of rotation in both halves.
void sort_around(Point centre, std::vector<Spoke>& spokes) {
  std::sort(spokes.begin(), spokes.end(), [centre](const Spoke& a, const Spoke& b) {
    if (a.goes_down != b.goes_down) return a.goes_down;
    return orientation(centre, a.far, b.far) < 0;
  });
}

// A pair that has been found is removed from the circle, and the edges before and after it become
// neighbours: between them lies the region that was on both sides of the pair.
std::vector<std::pair<EdgeId, EdgeId>> pair_spokes(const std::vector<Spoke>& spokes) {
  std::vector<std::pair<EdgeId, EdgeId>> pairs;
  std::vector<Spoke> left;  // edges up to the present one that have no partner
  for (const Spoke& spoke : spokes) {
    if (!left.empty() && left.back().before == spoke.following) {
      pairs.emplace_back(left.back().edge, spoke.edge);
      left.pop_back();
    } else {
      left.push_back(spoke);
    }
  }
  // Pairs across the point where the circle closes.
  std::span<const Spoke> open(left);
  while (open.size() > 1 && open.back().before == open.front().following) {
    pairs.emplace_back(open.back().edge, open.front().edge);
    open = open.subspan(1, open.size() - 2);
  }
  return pairs;
}

void BorderArcs::trace(const Boundary& boundary, FaceId faces, const Regions& regions,
                       TrapezoidalGraph& graph) {
  boundary_ = &boundary;
  graph.face_count_ = faces;
  const std::size_t count = boundary.edges.size();
  partner_.assign(2 * count, EdgeId());
  for (std::size_t v = 1; v + 1 < boundary.vertices.size(); ++v) {
    pair_edges(VertexId(v), regions, graph);
  }
  graph.corners_.assign(count, Corner{});
  // First the arcs that have ends, each from one of its ends; the remaining edges form loops.
  for (std::size_t i = 0; i < count; ++i) {
    const EdgeId e(i);
    for (const VertexId v : {boundary.edges[e].upper, boundary.edges[e].lower}) {
      if (partner(v, e).is_none() && graph.corners_[CornerId(i)].vertex.is_none())
        walk(v, e, graph);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (graph.corners_[CornerId(i)].vertex.is_none())
      walk(boundary.edges[EdgeId(i)].upper, EdgeId(i), graph);
  }
}

void BorderArcs::name_faces(std::span<const std::pair<FaceId, FaceId>> sides,
                            TrapezoidalGraph& graph) {
  for (std::size_t i = 0; i < sides.size(); ++i) {
    Edge& edge = graph.edges_[EdgeId(i)];
    edge.face[kLeft] = sides[i].first;
    edge.face[kRight] = sides[i].second;
  }
}

EdgeId& BorderArcs::partner(VertexId v, EdgeId e) {
  return partner_[2 * e.value + (boundary_->edges[e].lower == v)];
}

void BorderArcs::pair_edges(VertexId v, const Regions& regions, const TrapezoidalGraph& graph) {
  const auto edges = boundary_->edges_at(v);
  const auto set_partners = [&](EdgeId a, EdgeId b) {
    partner(v, a) = b;
    partner(v, b) = a;
  };
  if (edges.size() == 2) return set_partners(edges[0], edges[1]);
  spokes_.clear();
  for (const EdgeId e : edges) {
    spokes_.push_back(spoke_of(graph, v, e, regions.beside[e][kLeft], regions.beside[e][kRight]));
  }
  sort_around(graph.point(v), spokes_);
  for (const auto& [a, b] : pair_spokes(spokes_)) set_partners(a, b);
}

void BorderArcs::walk(VertexId start, EdgeId first, TrapezoidalGraph& graph) {
  auto& corners = graph.corners_;
  const BoundaryWalk walked = walk_boundary(
      *boundary_, start, first, [this](VertexId v, EdgeId e) { return partner(v, e); }, corners);
  if (walked.is_loop) return;
  corners[walked.last].next = corners.push_back(Corner{walked.end, {}, walked.last, {}});
}

}  // namespace trapeze
