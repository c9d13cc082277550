#include "core/graph/topological_consistency.h"

#include <algorithm>
#include <array>

namespace trapeze {
namespace {

Decision blocked_by(VertexId blocker, std::uint32_t walked) {
  return {Removal::blocked, blocker, walked};
}

bool joins(const Edge& e, VertexId a, VertexId b) {
  return e.end[kUp] == std::min(a, b) && e.end[kDown] == std::max(a, b);
}

// The boundary comes from `upper` through v to `lower`; the chord upper-lower runs on side t of it:
//
//      upper            Along both edges on side t, every line between two trapezoids goes through
//       | \             a vertex X; each must lie beyond the chord, seen from v.
//       |  v   . X
//       | /
//      lower    (t: left)
Decision decide_regular(const TrapezoidalGraph& g, CornerId c, Topology topology) {
  const Passage passage = passage_at(g, c);
  const VertexId v = g.corner(c).vertex;
  const Edge& above = g.edge(passage.upper_edge);
  const Edge& below = g.edge(passage.lower_edge);
  const VertexId upper = above.end[kUp];
  const VertexId lower = below.end[kDown];
  const std::int64_t turn = orientation(g.point(upper), g.point(lower), g.point(v));
  const auto is_lone_on = [&](Side s) {
    const NodeId over = above.extreme[s][kDown];
    return g.node(over).link[s][kDown] == below.extreme[s][kUp];
  };
  if (turn == 0) {
    // Otherwise, other loops that meet at v would touch the interior of the new edge.
    if (!is_lone_on(kLeft) || !is_lone_on(kRight)) return blocked_by(v, 2);
    return {Removal::regular, {}, 2};
  }
  const Side t = turn > 0 ? kRight : kLeft;
  if (!is_lone_on(t)) return blocked_by(v, 1);
  std::uint32_t walked = 0;
  for (const EdgeId e : {passage.upper_edge, passage.lower_edge}) {
    const Side own = opposite(t);  // of a node on side t, the side of the edge it lies along
    for (NodeId n = g.edge(e).extreme[t][kUp]; !n.is_none(); n = g.node(n).link[own][kDown]) {
      const Node& node = g.node(n);
      ++walked;
      if (joins(g.edge(node.edge[t]), upper, lower)) return blocked_by(upper, walked);
      const VertexId x = node.end[kDown];
      if (x == v || x == lower || topology == Topology::fast) continue;
      const std::int64_t side = orientation(g.point(upper), g.point(lower), g.point(x));
      if (side == 0 || (side > 0) == (turn > 0)) return blocked_by(x, walked);
    }
  }
  return {Removal::regular, {}, walked};
}

// Both neighbours of V lie beyond it in direction `away`, here downwards:
//
//          v
//         / \           The trapezoid between the edges must reach down to `near` itself. Below it,
//     near   \    far   the trapezoids along the far edge, on the side of the near one, are
//        .    \   edge  examined.
//            . far
Decision decide_extremum(const TrapezoidalGraph& g, CornerId c, Topology topology) {
  const Extremum x = extremum_at(g, c);
  const VertexId v = g.corner(c).vertex;
  const Edge& far_edge = g.edge(x.far_edge);
  const Direction back = opposite(x.away);
  Side s = kLeft;
  NodeId wedge = far_edge.extreme[s][back];
  if (g.node(wedge).edge[s] != x.near_edge) {
    s = kRight;
    wedge = far_edge.extreme[s][back];
    if (g.node(wedge).edge[s] != x.near_edge) return blocked_by(v, 2);  // other edges between them
  }
  if (g.node(wedge).end[x.away] != x.near_vertex) return blocked_by(g.node(wedge).end[x.away], 1);
  const std::int64_t inner = orientation(g.point(x.near_vertex), g.point(x.far_vertex), g.point(v));
  std::uint32_t walked = 1;
  const Side own = opposite(s);
  const NodeId first = g.node(wedge).link[own][x.away];
  if (joins(g.edge(g.node(first).edge[s]), x.near_vertex, x.far_vertex)) {
    return blocked_by(x.near_vertex, walked);
  }
  if (topology == Topology::strict) {
    for (NodeId n = first; !n.is_none(); n = g.node(n).link[own][x.away]) {
      ++walked;
      const VertexId other = g.node(n).end[x.away];
      if (other == x.far_vertex) break;
      const std::int64_t side =
          orientation(g.point(x.near_vertex), g.point(x.far_vertex), g.point(other));
      if (side == 0 || (side > 0) == (inner > 0)) return blocked_by(other, walked);
    }
  }
  return {Removal::extremum, {}, walked};
}

// The inside of the triangle must consist of the two trapezoids above and below its middle vertex.
Decision decide_loop(const TrapezoidalGraph& g, CornerId c) {
  const TriangleLoop loop = triangle_loop_at(g, c);
  const VertexId middle = g.corner(loop.middle).vertex;
  const VertexId bottom = g.corner(loop.bottom).vertex;
  const Node& first = g.node(g.edge(loop.long_edge).extreme[loop.side][kUp]);
  if (first.edge[loop.side] != loop.upper_edge) return blocked_by(g.corner(loop.top).vertex, 1);
  if (first.end[kDown] != middle) return blocked_by(first.end[kDown], 1);
  const Node& second = g.node(first.link[opposite(loop.side)][kDown]);
  if (second.edge[loop.side] != loop.lower_edge) return blocked_by(middle, 2);
  if (second.end[kDown] != bottom) return blocked_by(second.end[kDown], 2);
  return {Removal::loop, {}, 2};
}

}  // namespace

Extremum extremum_at(const TrapezoidalGraph& g, CornerId c) {
  const Corner& corner = g.corner(c);
  const VertexId v = corner.vertex;
  const VertexId a = g.corner(corner.prev).vertex;
  const VertexId b = g.corner(corner.next).vertex;
  const EdgeId edge_a = g.corner(corner.prev).edge;
  const EdgeId edge_b = corner.edge;
  Extremum x;
  x.away = a > v ? kDown : kUp;
  const bool a_is_near = (x.away == kDown) == (a < b);
  x.near_edge = a_is_near ? edge_a : edge_b;
  x.far_edge = a_is_near ? edge_b : edge_a;
  x.near_vertex = a_is_near ? a : b;
  x.far_vertex = a_is_near ? b : a;
  return x;
}

TriangleLoop triangle_loop_at(const TrapezoidalGraph& g, CornerId c) {
  std::array<CornerId, 3> by_level{c, g.corner(c).next, g.corner(c).prev};
  std::sort(by_level.begin(), by_level.end(),
            [&](CornerId a, CornerId b) { return g.corner(a).vertex < g.corner(b).vertex; });
  TriangleLoop loop;
  loop.top = by_level[0];
  loop.middle = by_level[1];
  loop.bottom = by_level[2];
  const auto edge_between = [&](CornerId a, CornerId b) {
    return g.corner(a).next == b ? g.corner(a).edge : g.corner(b).edge;
  };
  loop.upper_edge = edge_between(loop.top, loop.middle);
  loop.lower_edge = edge_between(loop.middle, loop.bottom);
  loop.long_edge = edge_between(loop.top, loop.bottom);
  const Node& left = g.node(g.edge(loop.long_edge).extreme[kLeft][kUp]);
  loop.side = left.edge[kLeft] == loop.upper_edge ? kLeft : kRight;
  return loop;
}

Passage passage_at(const TrapezoidalGraph& g, CornerId c) {
  const Corner& corner = g.corner(c);
  const EdgeId before = g.corner(corner.prev).edge;
  return g.corner(corner.prev).vertex < corner.vertex ? Passage{before, corner.edge}
                                                      : Passage{corner.edge, before};
}

Decision decide_removal(const TrapezoidalGraph& g, CornerId c, Topology topology) {
  const Corner& corner = g.corner(c);
  if (g.corner(corner.next).next == corner.prev) return decide_loop(g, c);
  const bool from_above = g.corner(corner.prev).vertex < corner.vertex;
  const bool to_below = corner.vertex < g.corner(corner.next).vertex;
  return from_above == to_below ? decide_regular(g, c, topology) : decide_extremum(g, c, topology);
}

}  // namespace trapeze
