#include "core/graph/trapezoidal_graph.h"

#include <algorithm>
#include <numeric>

namespace trapeze {
namespace {

/// The parts of the plane, inside and outside: nodes that are reachable from each other by links.
struct Parts {
  struct Part {
    NodeId start;           // the node with the topmost top
    NodeId end;             // the node with the bottommost bottom
    bool at_frame = false;  // the outside around everything
  };
  std::vector<Part> parts;
  std::vector<std::uint32_t> part_of;  // by node
};

Parts parts_of(const TrapezoidalGraph& g) {
  constexpr std::uint32_t kNoPart = 0xffffffff;
  Parts found;
  found.part_of.assign(g.nodes().size(), kNoPart);
  std::vector<NodeId> reached;
  for (std::size_t i = 0; i < g.nodes().size(); ++i) {
    if (!g.node(NodeId(i)).is_alive() || found.part_of[i] != kNoPart) continue;
    const auto number = static_cast<std::uint32_t>(found.parts.size());
    Parts::Part part{NodeId(i), NodeId(i)};
    const auto reach = [&](NodeId n) {
      if (found.part_of[n.value] != kNoPart) return;
      found.part_of[n.value] = number;
      reached.push_back(n);
    };
    reach(NodeId(i));
    while (!reached.empty()) {
      const NodeId n = reached.back();
      reached.pop_back();
      const Node& node = g.node(n);
      if (node.end[kUp] < g.node(part.start).end[kUp]) part.start = n;
      if (node.end[kDown] > g.node(part.end).end[kDown]) part.end = n;
      part.at_frame = part.at_frame || g.is_frame(node.edge[kLeft]);
      for (const auto& links : node.link) {
        for (const NodeId next : links) {
          if (!next.is_none()) reach(next);
        }
      }
    }
    found.parts.push_back(part);
  }
  return found;
}

/// The inside node above (d: up) or below the tip of a hole; if the hole touches the boundary
/// there, the node beside it.
NodeId beyond_tip(const TrapezoidalGraph& g, NodeId tip, Direction d) {
  const NodeId beside = g.edge(g.node(tip).edge[kLeft]).extreme[kLeft][d];
  const NodeId beyond = g.node(beside).link[kLeft][d];
  return beyond.is_none() ? beside : beyond;
}

/// The x of an edge at the y of a vertex that lies between its ends in sweep order. The sweep line
/// passes along a horizontal edge: it meets the edge at the vertex itself.
double x_at(const TrapezoidalGraph& g, EdgeId e, VertexId at) {
  const Point a = g.point(g.edge(e).end[kUp]);
  const Point b = g.point(g.edge(e).end[kDown]);
  const Point p = g.point(at);
  if (a.y == b.y) return p.x;
  return a.x + (static_cast<double>(b.x) - a.x) *
                   ((static_cast<double>(p.y) - a.y) / (static_cast<double>(b.y) - a.y));
}

}  // namespace

std::vector<NodeId> TrapezoidalGraph::inside_nodes() const {
  std::vector<NodeId> inside;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const NodeId n(i);
    if (nodes_[n].is_alive() && is_inside(n)) inside.push_back(n);
  }
  return inside;
}

TrapezoidalGraph::Neighbours TrapezoidalGraph::neighbours(NodeId n, Direction d) const {
  Neighbours found;
  const Node& node = nodes_[n];
  for (const Side side : {kLeft, kRight}) {
    const NodeId next = node.link[side][d];
    if (!next.is_none() && (found.count == 0 || found.node[0] != next)) {
      found.node[static_cast<std::size_t>(found.count++)] = next;
    }
  }
  return found;
}

std::vector<Link> TrapezoidalGraph::links() const {
  std::vector<Link> found = pseudo_links();
  for (const NodeId n : inside_nodes()) {
    const Neighbours below = neighbours(n, kDown);
    for (int i = 0; i < below.count; ++i) {
      const NodeId lower = below.node[static_cast<std::size_t>(i)];
      const LinkKind kind = below.count == 2                    ? LinkKind::division
                            : neighbours(lower, kUp).count == 2 ? LinkKind::join
                                                                : LinkKind::connection;
      found.push_back({n, lower, kind});
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<Link> TrapezoidalGraph::pseudo_links() const {
  const Parts all = parts_of(*this);
  std::vector<Link> found;
  for (const Parts::Part& part : all.parts) {
    if (!is_inside(part.start)) continue;
    // The area left of the topmost vertex of an inside part surrounds that part.
    const NodeId beside = edges_[nodes_[part.start].edge[kLeft]].extreme[kLeft][kUp];
    const Parts::Part& around = all.parts[all.part_of[beside.value]];
    if (around.at_frame) continue;
    found.push_back({beyond_tip(*this, around.start, kUp), part.start, LinkKind::pseudo_division});
    found.push_back({part.end, beyond_tip(*this, around.end, kDown), LinkKind::pseudo_join});
  }
  std::sort(found.begin(), found.end());
  return found;
}

Connectedness TrapezoidalGraph::connectedness(NodeId n) const {
  const bool up = neighbours(n, kUp).count > 0;
  const bool down = neighbours(n, kDown).count > 0;
  return up && down   ? Connectedness::two_sided
         : up || down ? Connectedness::one_sided
                      : Connectedness::isolated;
}

// Vertices are in sweep order, so the leftmost of several tops with the same y has the smallest id.
NodeId TrapezoidalGraph::starting_node() const {
  NodeId best;
  for (const NodeId n : inside_nodes()) {
    if (best.is_none() || nodes_[n].end[kUp] < nodes_[best].end[kUp]) best = n;
  }
  return best;
}

NodeId TrapezoidalGraph::ending_node() const {
  NodeId best;
  for (const NodeId n : inside_nodes()) {
    if (best.is_none() || nodes_[n].end[kDown] > nodes_[best].end[kDown]) best = n;
  }
  return best;
}

std::vector<std::vector<NodeId>> TrapezoidalGraph::chains() const {
  // The node that a connection link leads to; none where a chain ends.
  const auto next_in_chain = [this](NodeId n) {
    const Neighbours below = neighbours(n, kDown);
    if (below.count != 1 || neighbours(below.node[0], kUp).count != 1) return NodeId();
    return below.node[0];
  };
  const auto starts_chain = [&](NodeId n) {
    const Neighbours above = neighbours(n, kUp);
    return above.count != 1 || next_in_chain(above.node[0]).is_none();
  };
  std::vector<std::vector<NodeId>> found;
  for (const NodeId first : inside_nodes()) {
    if (!starts_chain(first)) continue;
    std::vector<NodeId>& chain = found.emplace_back();
    for (NodeId n = first; !n.is_none(); n = next_in_chain(n)) chain.push_back(n);
  }
  return found;
}

Int128 TrapezoidalGraph::doubled_area() const {
  const std::vector<Int128> areas = doubled_areas();
  return std::accumulate(areas.begin() + 1, areas.end(), Int128{0});
}

std::vector<Int128> TrapezoidalGraph::doubled_areas() const {
  // Between y0 and y1, twice the area left of an edge from u to l is
  //   (y1 - y0) * (2 x_u (y_l - y_u) + (x_l - x_u) (y0 + y1 - 2 y_u)) / (y_l - y_u).
  // The fraction is summed per side of an edge, and is whole once the pieces cover the edge from
  // end to end.
  std::vector<std::array<Int128, 2>> numerator(edges_.size(), {0, 0});
  for (const NodeId n : inside_nodes()) {
    const Node& node = nodes_[n];
    const std::int64_t y0 = vertices_[node.end[kUp]].y;
    const std::int64_t y1 = vertices_[node.end[kDown]].y;
    for (const Side side : {kLeft, kRight}) {
      const EdgeId e = node.edge[side];
      const Point u = vertices_[edges_[e].end[kUp]];
      const Point l = vertices_[edges_[e].end[kDown]];
      const Int128 dx = std::int64_t{l.x} - u.x;
      const Int128 dy = std::int64_t{l.y} - u.y;
      numerator[e.value][opposite(side)] +=
          (y1 - y0) * (2 * Int128{u.x} * dy + dx * (y0 + y1 - 2 * std::int64_t{u.y}));
    }
  }
  std::vector<Int128> areas(face_count_ + std::size_t{1}, 0);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Edge& edge = edges_[EdgeId(e)];
    for (const Side side : {kLeft, kRight}) {
      const Int128 sum = numerator[e][side];
      if (sum == 0) continue;
      const Int128 dy = std::int64_t{vertices_[edge.end[kDown]].y} - vertices_[edge.end[kUp]].y;
      areas[edge.face[side]] += side == kLeft ? sum / dy : -(sum / dy);
    }
  }
  return areas;
}

Int128 doubled_strip(const TrapezoidalGraph& graph, const Edge& edge) {
  const Point u = graph.point(edge.end[kUp]);
  const Point l = graph.point(edge.end[kDown]);
  return (Int128{u.x} + l.x) * (std::int64_t{l.y} - u.y);
}

std::size_t TrapezoidalGraph::memory() const {
  return vertices_.capacity() * sizeof(Point) + edges_.capacity() * sizeof(Edge) +
         nodes_.capacity() * sizeof(Node) + corners_.capacity() * sizeof(Corner);
}

std::vector<StripPoint> quad_strip(const TrapezoidalGraph& graph,
                                   const std::vector<NodeId>& chain) {
  std::vector<StripPoint> strip;
  const auto add_level = [&](const Node& node, Direction d) {
    const double y = graph.point(node.end[d]).y;
    for (const Side side : {kLeft, kRight})
      strip.push_back({x_at(graph, node.edge[side], node.end[d]), y});
  };
  if (chain.empty()) return strip;
  add_level(graph.node(chain.front()), kUp);
  for (const NodeId n : chain) add_level(graph.node(n), kDown);
  return strip;
}

Rings rings_of(const TrapezoidalGraph& g) {
  Rings rings;
  std::vector<bool> seen(g.corners().size(), false);
  for (std::size_t i = 0; i < g.corners().size(); ++i) {
    if (!g.corner(CornerId(i)).is_alive() || seen[i]) continue;
    for (CornerId c(i); !seen[c.value]; c = g.corner(c).next) {
      seen[c.value] = true;
      rings.points.push_back(g.point(g.corner(c).vertex));
    }
    rings.close_ring();
  }
  return rings;
}

}  // namespace trapeze
