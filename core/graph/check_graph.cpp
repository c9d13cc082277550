#include "core/graph/check_graph.h"

#include <algorithm>
#include <sstream>
#include <tuple>
#include <utility>

namespace trapeze {
namespace {

/// The x of an edge at the y of a vertex, as a fraction with a positive denominator; exact.
struct Fraction {
  Int128 num;
  Int128 den;
};

Fraction exact_x_at(const TrapezoidalGraph& g, EdgeId e, VertexId at) {
  const Point u = g.point(g.edge(e).end[kUp]);
  const Point l = g.point(g.edge(e).end[kDown]);
  const Point p = g.point(at);
  const Int128 dy = std::int64_t{l.y} - u.y;
  // The sweep line passes along a horizontal edge from left to right: it meets the edge at p
  // itself.
  if (dy == 0) return {p.x, 1};
  return {Int128{u.x} * dy + (Int128{l.x} - u.x) * (std::int64_t{p.y} - u.y), dy};
}

class Checker {
 public:
  explicit Checker(const TrapezoidalGraph& graph) : g_(graph) {}

  std::string run() {
    check_vertices();
    check_edges();
    for (std::size_t i = 0; i < g_.nodes().size() && ok(); ++i) {
      if (g_.node(NodeId(i)).is_alive()) check_node(NodeId(i));
    }
    for (std::size_t i = 0; i < g_.edges().size() && ok(); ++i) {
      if (g_.edge(EdgeId(i)).is_alive()) check_lists(EdgeId(i));
    }
    if (ok()) check_corners();
    if (ok()) check_area();
    return failure_;
  }

 private:
  bool ok() const { return failure_.empty(); }

  template <class... Words>
  void require(bool condition, const Words&... words) {
    if (condition || !ok()) return;
    std::ostringstream out;
    (out << ... << words);
    failure_ = out.str();
  }

  void check_vertices() {
    for (std::size_t v = 2; v <= g_.vertex_count(); ++v) {
      require(is_above(g_.point(VertexId(v - 1)), g_.point(VertexId(v))), "I1: vertices ", v - 1,
              " and ", v, " are not in sweep order");
    }
  }

  void check_edges() {
    std::vector<std::pair<VertexId, VertexId>> ends;
    for (std::size_t i = 0; i < g_.edges().size(); ++i) {
      const Edge& e = g_.edge(EdgeId(i));
      if (!e.is_alive() || g_.is_frame(EdgeId(i))) continue;
      require(e.end[kUp] < e.end[kDown], "I2: edge ", i, " does not go down");
      require(!g_.is_frame(e.end[kUp]) && !g_.is_frame(e.end[kDown]), "I2: edge ", i,
              " ends at the frame");
      require(e.face[kLeft] != e.face[kRight], "I7: edge ", i, " separates nothing");
      ends.emplace_back(e.end[kUp], e.end[kDown]);
    }
    std::sort(ends.begin(), ends.end());
    require(std::adjacent_find(ends.begin(), ends.end()) == ends.end(),
            "I2: two edges have the same ends");
  }

  void check_node(NodeId id) {
    const Node& n = g_.node(id);
    require(n.end[kUp] < n.end[kDown], "I3: node ", id.value, " is not above its bottom");
    for (const Side s : {kLeft, kRight}) {
      const Edge& e = g_.edge(n.edge[s]);
      require(e.is_alive(), "I3: node ", id.value, " has a dead edge");
      if (!ok()) return;
      require(e.end[kUp] <= n.end[kUp] && n.end[kDown] <= e.end[kDown], "I3: edge ",
              n.edge[s].value, " does not span node ", id.value);
      for (const Direction d : {kUp, kDown}) {
        const NodeId next = n.link[s][d];
        require(next.is_none() == (e.end[d] == n.end[d]), "I5: node ", id.value,
                " is linked beyond the end of an edge, or not linked along it");
        if (next.is_none() || !ok()) continue;
        const Node& m = g_.node(next);
        require(m.is_alive() && m.link[s][opposite(d)] == id && m.edge[s] == n.edge[s] &&
                    m.end[opposite(d)] == n.end[d],
                "I4: the link between nodes ", id.value, " and ", next.value, " is not symmetric");
      }
    }
    if (!ok()) return;
    require(g_.edge(n.edge[kLeft]).face[kRight] == g_.edge(n.edge[kRight]).face[kLeft], "I7: node ",
            id.value, " has two faces");
    if (g_.is_frame(n.edge[kLeft]) || g_.is_frame(n.edge[kRight])) {
      require(g_.face(n) == kOutside, "I7: node ", id.value, " at the frame is inside");
      return;
    }
    for (const Direction d : {kUp, kDown}) {
      const Fraction l = exact_x_at(g_, n.edge[kLeft], n.end[d]);
      const Fraction r = exact_x_at(g_, n.edge[kRight], n.end[d]);
      require(l.num * r.den <= r.num * l.den, "I3: the edges of node ", id.value, " cross");
    }
  }

  void check_lists(EdgeId id) {
    const Edge& e = g_.edge(id);
    for (const Side s : {kLeft, kRight}) {
      // A node left of the edge has it as its right edge.
      const Side own = opposite(s);
      if (g_.is_frame(id) && id == g_.frame_edge(s)) continue;  // nothing beyond the frame
      NodeId n = e.extreme[s][kUp];
      VertexId top = e.end[kUp];
      NodeId last;
      while (!n.is_none() && ok()) {
        const Node& node = g_.node(n);
        require(node.is_alive() && node.edge[own] == id && node.end[kUp] == top,
                "I6: the nodes along edge ", id.value, " do not follow each other");
        top = node.end[kDown];
        last = n;
        n = node.link[own][kDown];
      }
      require(top == e.end[kDown] && last == e.extreme[s][kDown], "I6: the nodes along edge ",
              id.value, " do not reach its end");
      if (!ok()) return;
    }
  }

  void check_corners() {
    std::vector<int> uses(g_.edges().size(), 0);
    std::vector<std::pair<std::uint32_t, VertexId>> visits;  // loop or arc, and vertex
    std::vector<bool> seen(g_.corners().size(), false);
    std::uint32_t runs = 0;
    const auto walk = [&](CornerId first) {
      std::size_t length = 0;
      for (CornerId c = first; !c.is_none() && !seen[c.value] && ok(); c = g_.corner(c).next) {
        seen[c.value] = true;
        ++length;
        check_corner(c, uses);
        // An arc may return to its first vertex.
        const bool is_last = g_.corner(c).next.is_none();
        if (!is_last) visits.emplace_back(runs, g_.corner(c).vertex);
      }
      ++runs;
      return length;
    };
    for (std::size_t i = 0; i < g_.corners().size() && ok(); ++i) {
      const Corner& corner = g_.corner(CornerId(i));
      if (!corner.is_end() || !corner.prev.is_none()) continue;
      require(g_.is_coverage(), "I9: corner ", i, " begins an arc");
      require(walk(CornerId(i)) >= 2, "I9: an arc has one corner");
    }
    for (std::size_t i = 0; i < g_.corners().size() && ok(); ++i) {
      if (!g_.corner(CornerId(i)).is_alive() || seen[i]) continue;
      const std::size_t length = walk(CornerId(i));
      require(length >= 3, "I9: a loop has ", length, " corners");
    }
    for (std::size_t e = 0; e < uses.size(); ++e) {
      const bool wanted = g_.edge(EdgeId(e)).is_alive() && !g_.is_frame(EdgeId(e));
      require(uses[e] == (wanted ? 1 : 0), "I9: edge ", e, " belongs to ", uses[e], " loops");
    }
    std::sort(visits.begin(), visits.end());
    require(std::adjacent_find(visits.begin(), visits.end()) == visits.end(),
            "I9: a loop visits a vertex twice");
  }

  void check_corner(CornerId c, std::vector<int>& uses) {
    const Corner& corner = g_.corner(c);
    require(corner.next.is_none() == corner.edge.is_none(), "I9: corner ", c.value,
            " has an edge and nothing at its end, or none");
    if (!ok() || corner.next.is_none()) return;
    const Corner& next = g_.corner(corner.next);
    require(next.is_alive() && next.prev == c, "I9: corners ", c.value, " and ", corner.next.value,
            " do not follow each other");
    if (!ok()) return;
    const Edge& e = g_.edge(corner.edge);
    require(e.is_alive() && e.end[kUp] == std::min(corner.vertex, next.vertex) &&
                e.end[kDown] == std::max(corner.vertex, next.vertex),
            "I9: edge ", corner.edge.value, " is not between its corners");
    ++uses[corner.edge.value];
    if (!next.next.is_none()) check_faces_go_on(corner, next);
  }

  /// An arc has the same two faces all along; the sides are swapped where its direction changes
  /// between up and down.
  void check_faces_go_on(const Corner& corner, const Corner& next) {
    const auto face_on_the_left = [this](const Corner& from) {
      const Edge& e = g_.edge(from.edge);
      return e.face[e.end[kUp] == from.vertex ? kRight : kLeft];
    };
    const auto face_on_the_right = [this](const Corner& from) {
      const Edge& e = g_.edge(from.edge);
      return e.face[e.end[kUp] == from.vertex ? kLeft : kRight];
    };
    require(face_on_the_left(corner) == face_on_the_left(next) &&
                face_on_the_right(corner) == face_on_the_right(next),
            "I9: the faces beside edges ", corner.edge.value, " and ", next.edge.value,
            " of one loop differ");
  }

  void check_area() {
    std::vector<Int128> areas(g_.face_count() + 1, 0);
    for (std::size_t i = 0; i < g_.edges().size(); ++i) {
      const Edge& e = g_.edge(EdgeId(i));
      if (!e.is_alive() || g_.is_frame(EdgeId(i))) continue;
      require(std::max(e.face[kLeft], e.face[kRight]) <= g_.face_count(), "I7: edge ", i,
              " has a face that there is not");
      if (!ok()) return;
      const Int128 strip = doubled_strip(g_, e);
      areas[e.face[kLeft]] += strip;
      areas[e.face[kRight]] -= strip;
    }
    const std::vector<Int128> tiled = g_.doubled_areas();
    for (FaceId face = 1; face <= g_.face_count(); ++face) {
      require(areas[face] == tiled[face], "I8: the areas of the nodes of face ", face,
              " do not add up to the polygon's");
    }
  }

  const TrapezoidalGraph& g_;
  std::string failure_;
};

auto key_of(Point p) {
  return std::pair(p.y, p.x);
}

}  // namespace

std::string check_graph(const TrapezoidalGraph& graph) {
  return Checker(graph).run();
}

std::vector<PlainTrapezoid> plain_trapezoids(const TrapezoidalGraph& g) {
  std::vector<PlainTrapezoid> found;
  const auto point = [&](VertexId v) { return g.is_frame(v) ? Point{} : g.point(v); };
  for (const Node& n : g.nodes()) {
    if (!n.is_alive()) continue;
    PlainTrapezoid t{point(n.end[kUp]), point(n.end[kDown]), {}, {}, g.face(n)};
    for (const Direction d : {kUp, kDown}) {
      t.left[d] = point(g.edge(n.edge[kLeft]).end[d]);
      t.right[d] = point(g.edge(n.edge[kRight]).end[d]);
    }
    found.push_back(t);
  }
  std::sort(found.begin(), found.end(), [](const PlainTrapezoid& a, const PlainTrapezoid& b) {
    const auto key = [](const PlainTrapezoid& t) {
      return std::tuple(key_of(t.top), key_of(t.bottom), key_of(t.left[0]), key_of(t.left[1]),
                        key_of(t.right[0]), key_of(t.right[1]), t.face);
    };
    return key(a) < key(b);
  });
  return found;
}

}  // namespace trapeze
