#include "core/trapezoidal_graph.h"

#include <algorithm>
#include <numeric>

namespace trapeze {
namespace {

constexpr LinkKind pseudo(Direction d) {
  return d == kUp ? LinkKind::pseudo_division : LinkKind::pseudo_join;
}

/// Follows outside nodes from the tip of an island in direction `d` to the end of the hole around
/// it, and returns the inside node beyond; none if the outside is not a hole but reaches the frame.
NodeId beyond_hole(const TrapezoidalGraph& g, NodeId tip, Direction d) {
  // The outside node left of the island's leftmost edge at its tip.
  NodeId n = g.edge(g.node(tip).edge[kLeft]).extreme[kLeft][d];
  for (;;) {
    const Node& node = g.node(n);
    if (g.is_frame(node.edge[kLeft]) || g.is_frame(node.edge[kRight])) return NodeId();
    const auto next = g.neighbours(n, d);
    if (next.count == 0) break;
    n = next.node[0];
  }
  // n is a tip of the hole: its edges meet, and left of them is the inside, which goes on beyond.
  const NodeId beside = g.edge(g.node(n).edge[kLeft]).extreme[kLeft][d];
  const NodeId beyond = g.node(beside).link[kLeft][d];
  return beyond.is_none() ? beside : beyond;
}

double x_at(const TrapezoidalGraph& g, EdgeId e, double y) {
  const Point a = g.point(g.edge(e).end[kUp]);
  const Point b = g.point(g.edge(e).end[kDown]);
  if (a.y == b.y) return a.x;
  return a.x + (static_cast<double>(b.x) - a.x) * ((y - a.y) / (static_cast<double>(b.y) - a.y));
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
  // Connected parts of the inside; each but those at the outermost level hangs in a hole.
  const std::vector<NodeId> inside = inside_nodes();
  std::vector<bool> seen(nodes_.size(), false);
  std::vector<Link> found;
  std::vector<NodeId> part;
  for (const NodeId first : inside) {
    if (seen[first.value]) continue;
    part.assign(1, first);
    seen[first.value] = true;
    NodeId start = first;
    NodeId end = first;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const NodeId n = part[i];
      if (nodes_[n].end[kUp] < nodes_[start].end[kUp]) start = n;
      if (nodes_[n].end[kDown] > nodes_[end].end[kDown]) end = n;
      for (const Direction d : {kUp, kDown}) {
        const Neighbours next = neighbours(n, d);
        for (int k = 0; k < next.count; ++k) {
          const NodeId m = next.node[static_cast<std::size_t>(k)];
          if (!seen[m.value]) {
            seen[m.value] = true;
            part.push_back(m);
          }
        }
      }
    }
    const NodeId above = beyond_hole(*this, start, kUp);
    const NodeId below = beyond_hole(*this, end, kDown);
    if (!above.is_none()) found.push_back({above, start, pseudo(kUp)});
    if (!below.is_none()) found.push_back({end, below, pseudo(kDown)});
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

// Vertices are in sweep order, so of several level tops the leftmost has the smallest id.
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
  // Between two levels, twice the area left of an edge from u to l is
  //   (y1 - y0) * (2 x_u (y_l - y_u) + (x_l - x_u) (y0 + y1 - 2 y_u)) / (y_l - y_u).
  // The fraction is summed per edge, and is whole once the pieces cover the edge from end to end.
  std::vector<Int128> numerator(edges_.size(), 0);
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
      const Int128 piece =
          (y1 - y0) * (2 * Int128{u.x} * dy + dx * (y0 + y1 - 2 * std::int64_t{u.y}));
      numerator[e.value] += side == kRight ? piece : -piece;
    }
  }
  Int128 area = 0;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    if (numerator[e] == 0) continue;
    const Edge& edge = edges_[EdgeId(e)];
    const Int128 dy = std::int64_t{vertices_[edge.end[kDown]].y} - vertices_[edge.end[kUp]].y;
    area += numerator[e] / dy;
  }
  return area;
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
    for (const Side side : {kLeft, kRight}) strip.push_back({x_at(graph, node.edge[side], y), y});
  };
  if (chain.empty()) return strip;
  add_level(graph.node(chain.front()), kUp);
  for (const NodeId n : chain) add_level(graph.node(n), kDown);
  return strip;
}

}  // namespace trapeze
