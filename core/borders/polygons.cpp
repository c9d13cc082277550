#include "core/borders/polygons.h"

#include <algorithm>
#include <tuple>

#include "core/borders/coverage_builder.h"
#include "core/sweep/graph_builder.h"

namespace trapeze {
namespace {

constexpr std::uint32_t kNoPart = 0xffffffff;

/// The connected part of the inside to which each node belongs.
class InsideParts {
 public:
  explicit InsideParts(const TrapezoidalGraph& graph) : g_(graph) {
    part_.assign(graph.nodes().size(), kNoPart);
    for (const NodeId n : graph.inside_nodes()) {
      if (part_[n] == kNoPart) flood(n, count_++);
    }
  }

  std::uint32_t count() const { return count_; }
  std::uint32_t operator[](NodeId n) const { return part_[n]; }

 private:
  void flood(NodeId start, std::uint32_t part) {
    part_[start] = part;
    waiting_.assign(1, start);
    while (!waiting_.empty()) {
      const NodeId n = waiting_.back();
      waiting_.pop_back();
      for (const auto& links : g_.node(n).link) {
        for (const NodeId next : links) {
          if (next.is_none() || part_[next] != kNoPart) continue;
          part_[next] = part;
          waiting_.push_back(next);
        }
      }
    }
  }

  const TrapezoidalGraph& g_;
  Table<NodeId, std::uint32_t> part_;
  std::vector<NodeId> waiting_;
  std::uint32_t count_ = 0;
};

struct Loop {
  CornerId top;        // its topmost vertex
  bool goes_left;      // from its top, it follows the left one of the two edges to the next corner
  bool is_shell;       // the inside is within the loop
  std::uint32_t part;  // the part of the inside that its edges bound
};

EdgeId edge_before(const TrapezoidalGraph& g, CornerId c) {
  return g.corner(g.corner(c).prev).edge;
}

/// Both edges lead downwards from the top; the nodes between them, beside either edge, are inside
/// the loop.
Loop describe_loop(const TrapezoidalGraph& g, const InsideParts& parts, CornerId top) {
  const Point p = g.point(g.corner(top).vertex);
  const EdgeId out = g.corner(top).edge;
  const EdgeId in = edge_before(g, top);
  const auto lower_end = [&](EdgeId e) { return g.point(g.edge(e).end[kDown]); };
  const bool goes_left = orientation(p, lower_end(out), lower_end(in)) < 0;
  const Edge& left = g.edge(goes_left ? out : in);
  const Side inner = left.face[kRight] != kOutside ? kRight : kLeft;
  return {top, goes_left, inner == kRight, parts[left.extreme[inner][kUp]]};
}

std::vector<Loop> find_loops(const TrapezoidalGraph& g, const InsideParts& parts) {
  std::vector<Loop> loops;
  std::vector<bool> seen(g.corners().size(), false);
  for (std::size_t i = 0; i < g.corners().size(); ++i) {
    if (!g.corner(CornerId(i)).is_alive() || seen[i]) continue;
    CornerId top(i);
    for (CornerId c(i); !seen[c.value]; c = g.corner(c).next) {
      seen[c.value] = true;
      if (g.corner(c).vertex < g.corner(top).vertex) top = c;
    }
    loops.push_back(describe_loop(g, parts, top));
  }
  return loops;
}

/// Shells run counterclockwise (from the top along the left edge first), holes clockwise.
void append_ring(const TrapezoidalGraph& g, const Loop& loop, Rings& rings) {
  const bool is_forward = loop.goes_left == loop.is_shell;
  CornerId c = loop.top;
  do {
    rings.points.push_back(g.point(g.corner(c).vertex));
    c = is_forward ? g.corner(c).next : g.corner(c).prev;
  } while (c != loop.top);
  rings.close_ring();
}

/// Sorts by polygon: the shell first, then the holes from top to bottom; polygons by the top of
/// their shells. Two loops that hang from the same vertex are ordered by their edges: they differ
/// in the lower end of the first edge.
void sort_loops(const TrapezoidalGraph& g, std::uint32_t parts, std::vector<Loop>& loops) {
  const auto place = [&](const Loop& loop) {
    const EdgeId out = g.corner(loop.top).edge;
    const EdgeId in = edge_before(g, loop.top);
    return std::tuple(g.corner(loop.top).vertex, g.edge(loop.goes_left ? out : in).end[kDown]);
  };
  std::vector<decltype(place(loops[0]))> shell(parts);
  for (const Loop& loop : loops) {
    if (loop.is_shell) shell[loop.part] = place(loop);
  }
  const auto key = [&](const Loop& loop) {
    return std::tuple(shell[loop.part], !loop.is_shell, place(loop));
  };
  std::sort(loops.begin(), loops.end(),
            [&](const Loop& a, const Loop& b) { return key(a) < key(b); });
}

void append_polygons(const TrapezoidalGraph& g, Polygons& polygons) {
  const InsideParts parts(g);
  std::vector<Loop> loops = find_loops(g, parts);
  sort_loops(g, parts.count(), loops);
  for (const Loop& loop : loops) {
    if (loop.is_shell && !polygons.rings.empty()) {
      polygons.ends.push_back(static_cast<std::uint32_t>(polygons.rings.size()));
    }
    append_ring(g, loop, polygons.rings);
  }
  polygons.ends.push_back(static_cast<std::uint32_t>(polygons.rings.size()));
}

std::vector<Polygons> polygons_of_each(std::vector<Rings> features) {
  std::vector<Polygons> polygons;
  polygons.reserve(features.size());
  for (Rings& rings : features) polygons.push_back(polygons_of(rings));
  return polygons;
}

}  // namespace

Polygons polygons_of(Rings& rings) {
  Polygons polygons;
  TrapezoidalGraph fresh;
  GraphBuilder builder;
  const BuildOutcome outcome = builder.build(rings, fresh);
  polygons.is_noded = outcome.noded;
  polygons.failure = outcome.failure;
  if (outcome.built) append_polygons(fresh, polygons);
  return polygons;
}

// The corners of an adapted graph may not suffice: without the topological consistency test its
// edges may cross.
Polygons polygons_of(const TrapezoidalGraph& graph) {
  Rings rings = rings_of(graph);
  return polygons_of(rings);
}

std::vector<Polygons> polygons_of_faces(const TrapezoidalGraph& graph) {
  return polygons_of_each(rings_of_faces(graph));
}

std::vector<Polygons> polygons_of_features(const TrapezoidalGraph& graph,
                                           const FaceFeatures& faces) {
  return polygons_of_each(rings_of_features(graph, faces));
}

}  // namespace trapeze
