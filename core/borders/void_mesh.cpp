#include "core/borders/void_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace trapeze {
namespace {

/// Whether d lies inside the circle through a, b and c, whose orientation is positive. Exact: twice
/// the area of a triangle is at most 2^62 and a squared distance at most 2^63, so the sum of three
/// products is less than 2^127.
bool is_in_circle(Point a, Point b, Point c, Point d) {
  const auto squared = [d](Point p) {
    const Int128 x = std::int64_t{p.x} - d.x;
    const Int128 y = std::int64_t{p.y} - d.y;
    return x * x + y * y;
  };
  return squared(a) * orientation(d, b, c) + squared(b) * orientation(d, c, a) +
             squared(c) * orientation(d, a, b) >
         0;
}

double length_between(Point a, Point b) {
  return std::hypot(static_cast<double>(b.x) - a.x, static_cast<double>(b.y) - a.y);
}

}  // namespace

VoidMesh::VoidMesh(const TrapezoidalGraph& graph)
    : graph_(graph),
      points_(graph.vertices().begin(), graph.vertices().end()),
      has_failed_(graph.vertex_count() > kMostVertices) {
  if (has_failed_) return;
  triangulate();
  make_delaunay();
}

bool VoidMesh::is_beyond(std::uint32_t triangle) const {
  const HalfEdge h = 3 * triangle;
  return corners_[h] == kInfinity || corners_[h + 1] == kInfinity || corners_[h + 2] == kInfinity;
}

std::vector<VoidMesh::HalfEdge> VoidMesh::walls() const {
  std::vector<HalfEdge> halves;
  halves.reserve(walls_.size());
  for (const Wall& wall : walls_) halves.push_back(wall.half);
  return halves;
}

double VoidMesh::length(HalfEdge h) const {
  return length_between(corner(h), corner(next(h)));
}

double VoidMesh::distance_across(HalfEdge h) const {
  const Point a = corner(h);
  const Point b = corner(next(h));
  const Point c = corner(before(h));
  const double x = static_cast<double>(b.x) - a.x;
  const double y = static_cast<double>(b.y) - a.y;
  const double along = (static_cast<double>(c.x) - a.x) * x + (static_cast<double>(c.y) - a.y) * y;
  if (along <= 0) return length_between(a, c);
  const double squared = x * x + y * y;
  if (along >= squared) return length_between(b, c);
  return std::abs(static_cast<double>(orientation(a, b, c))) / std::sqrt(squared);
}

// Beside an edge from U to L, the lines between the top and bottom vertices of the nodes along it
// form a chain:
//
//        U                        U -.
//        |\   1                   |   `- B1     The part of each node on this side of the line
//        | `--- B1                |     /       belongs to the polygon beside the edge, and the
//        |   2                    |    /        part beyond to the one beside its other edge. If
//        |----- B2                |  B2         the line is that other edge, there is no part
//        |   3                    | /           beyond.
//        L                        L
//
// So every part of the void is in exactly one such polygon (Fournier and Montuno).
void VoidMesh::triangulate() {
  seams_.assign(graph_.nodes().size(), kUnknown);
  for (std::size_t i = 0; i < graph_.edges().size(); ++i) {
    const EdgeId e(i);
    if (graph_.is_frame(e)) continue;
    for (const Side s : {kLeft, kRight}) {
      if (graph_.edge(e).face[s] == kOutside) triangulate_beside(e, s);
    }
  }
  close_hull(surround());
}

VoidMesh::Seam VoidMesh::seam_through(NodeId n, Side beyond) const {
  const Node& node = graph_.node(n);
  const EdgeId other = node.edge[beyond];
  const Edge& edge = graph_.edge(other);
  if (edge.end[kUp] == node.end[kUp] && edge.end[kDown] == node.end[kDown]) {
    return {Seam::Kind::wall, other.value};
  }
  return {Seam::Kind::node, n.value};
}

/// The vertices of the chain wait until they are corners of a triangle that lies within.
void VoidMesh::triangulate_beside(EdgeId e, Side s) {
  struct Waiting {
    VertexId vertex;
    Seam seam;  // to the previous vertex
  };
  const Edge& edge = graph_.edge(e);
  if (edge.extreme[s][kUp] == edge.extreme[s][kDown]) return;
  std::vector<Waiting> chain = {{edge.end[kUp], {}}};
  for (NodeId n = edge.extreme[s][kUp]; !n.is_none(); n = graph_.node(n).link[opposite(s)][kDown]) {
    Waiting next{graph_.node(n).end[kDown], seam_through(n, s)};
    while (chain.size() > 1) {
      const VertexId a = chain[chain.size() - 2].vertex;
      const VertexId b = chain.back().vertex;
      const std::int64_t turn =
          orientation(points_[a.value], points_[b.value], points_[next.vertex.value]);
      if (s == kLeft ? turn >= 0 : turn <= 0) break;
      const HalfEdge h =
          3 * (s == kLeft ? add_triangle(a, next.vertex, b) : add_triangle(a, b, next.vertex));
      connect(s == kLeft ? h + 2 : h, chain.back().seam);
      connect(h + 1, next.seam);
      next.seam = {Seam::Kind::half_edge, s == kLeft ? h : h + 2};
      chain.pop_back();
    }
    chain.push_back(next);
  }
  set_twin(chain.back().seam.number, wall_of(e));
}

/// Creates the triangles beyond the hull, left and right, from top to bottom.
std::array<std::vector<VoidMesh::HalfEdge>, 2> VoidMesh::surround() {
  std::array<std::vector<HalfEdge>, 2> around;
  for (const Side frame : {kLeft, kRight}) {
    const Side s = opposite(frame);
    const Edge& edge = graph_.edge(graph_.frame_edge(frame));
    for (NodeId n = edge.extreme[s][kUp]; !n.is_none(); n = graph_.node(n).link[frame][kDown]) {
      const VertexId top = graph_.node(n).end[kUp];
      const VertexId bottom = graph_.node(n).end[kDown];
      if (graph_.is_frame(top) || graph_.is_frame(bottom)) continue;
      const HalfEdge h = 3 * (frame == kLeft ? add_triangle(top, bottom, kInfinity)
                                             : add_triangle(bottom, top, kInfinity));
      connect(h, seam_through(n, s));
      around[frame].push_back(h);
    }
  }
  return around;
}

void VoidMesh::close_hull(const std::array<std::vector<HalfEdge>, 2>& around) {
  for (std::size_t i = 1; i < around[kLeft].size(); ++i) {
    set_twin(around[kLeft][i - 1] + 1, around[kLeft][i] + 2);
  }
  for (std::size_t i = 1; i < around[kRight].size(); ++i) {
    set_twin(around[kRight][i - 1] + 2, around[kRight][i] + 1);
  }
  set_twin(around[kLeft].front() + 2, around[kRight].front() + 1);
  set_twin(around[kLeft].back() + 1, around[kRight].back() + 2);
}

std::uint32_t VoidMesh::add_triangle(VertexId a, VertexId b, VertexId c) {
  corners_.insert(corners_.end(), {a, b, c});
  twins_.resize(corners_.size(), kUnknown);
  return static_cast<std::uint32_t>(corners_.size() / 3 - 1);
}

void VoidMesh::connect(HalfEdge h, const Seam& seam) {
  if (seam.kind == Seam::Kind::half_edge) return set_twin(h, seam.number);
  if (seam.kind == Seam::Kind::wall) return set_twin(h, wall_of(EdgeId(std::size_t{seam.number})));
  HalfEdge& other = seams_[NodeId(std::size_t{seam.number})];
  if (other == kUnknown) {
    other = h;
  } else {
    set_twin(h, other);
  }
}

void VoidMesh::set_twin(HalfEdge h, std::uint32_t beyond) {
  twins_[h] = beyond;
  if ((beyond & kWallBit) != 0) {
    walls_[beyond & ~kWallBit].half = h;
  } else {
    twins_[beyond] = h;
  }
}

std::uint32_t VoidMesh::wall_of(EdgeId e) {
  walls_.push_back({e, kUnknown});
  return static_cast<std::uint32_t>(walls_.size() - 1) | kWallBit;
}

void VoidMesh::make_delaunay() {
  for (HalfEdge h = 0; h < twins_.size(); ++h) {
    if (!is_wall(h) && h < twins_[h]) suspects_.push_back(h);
  }
  // With real data, two to ten edges per vertex are flipped; in the worst case, as many as there
  // are pairs of vertices.
  const std::uint64_t most = (std::uint64_t{1} << 22) + 256 * std::uint64_t{points_.size()};
  while (!suspects_.empty() && !has_failed_) {
    const HalfEdge h = suspects_.back();
    suspects_.pop_back();
    if (!is_to_be_exchanged(h)) continue;
    exchange(h);
    has_failed_ = ++exchanges_ > most;
  }
}

/// Between two triangles beyond the hull, the edge is flipped where the hull is not convex.
bool VoidMesh::is_to_be_exchanged(HalfEdge h) const {
  if (is_wall(h)) return false;
  const VertexId a = corners_[h];
  const VertexId b = corners_[next(h)];
  const VertexId c = corners_[before(h)];
  const VertexId d = corners_[before(twins_[h])];
  if (c == kInfinity || d == kInfinity) return false;
  const auto at = [this](VertexId v) { return points_[v.value]; };
  if (a == kInfinity) return orientation(at(d), at(b), at(c)) > 0;
  if (b == kInfinity) return orientation(at(a), at(d), at(c)) > 0;
  return is_in_circle(at(a), at(b), at(c), at(d));
}

//        c                c
//       / \              /|\      h leads from a to b, its twin from b to a
//      a---b     ->     a | b
//       \ /              \|/
//        d                d
void VoidMesh::exchange(HalfEdge h) {
  const HalfEdge other = twins_[h];
  const VertexId a = corners_[h];
  const VertexId b = corners_[next(h)];
  const VertexId c = corners_[before(h)];
  const VertexId d = corners_[before(other)];
  const std::uint32_t beyond_bc = twins_[next(h)];
  const std::uint32_t beyond_ca = twins_[before(h)];
  const std::uint32_t beyond_ad = twins_[next(other)];
  const std::uint32_t beyond_db = twins_[before(other)];
  const HalfEdge t = 3 * triangle_of(h);
  const HalfEdge u = 3 * triangle_of(other);
  corners_[t] = a;
  corners_[t + 1] = d;
  corners_[t + 2] = c;
  corners_[u] = d;
  corners_[u + 1] = b;
  corners_[u + 2] = c;
  set_twin(t, beyond_ad);
  set_twin(t + 2, beyond_ca);
  set_twin(u, beyond_db);
  set_twin(u + 1, beyond_bc);
  set_twin(t + 1, u + 2);
  suspects_.insert(suspects_.end(), {t, t + 2, u, u + 1});
}

void VoidMesh::divide_walls(double reach) {
  // A foot may bring another vertex near; a few passes do most of the work.
  constexpr int kMostPasses = 4;
  for (int pass = 0; pass < kMostPasses && !has_failed_; ++pass) {
    bool has_divided = false;
    const std::size_t count = walls_.size();
    for (std::uint32_t wall = 0; wall < count; ++wall) {
      has_divided = divide_at_foot(wall, reach) || has_divided;
    }
    if (!has_divided) return;
    make_delaunay();
  }
}

bool VoidMesh::divide_at_foot(std::uint32_t wall, double reach) {
  const HalfEdge h = walls_[wall].half;
  if (is_beyond(triangle_of(h))) return false;
  // Only original vertices count, so that the process ends.
  if (corners_[before(h)].value >= graph_.vertices().size()) return false;
  const Point a = corner(h);
  const Point b = corner(next(h));
  const Point c = corner(before(h));
  const double to_a = length_between(a, c);
  const double to_b = length_between(b, c);
  const double x = static_cast<double>(b.x) - a.x;
  const double y = static_cast<double>(b.y) - a.y;
  const double share =
      ((static_cast<double>(c.x) - a.x) * x + (static_cast<double>(c.y) - a.y) * y) /
      (x * x + y * y);
  const bool is_obtuse = to_a * to_a + to_b * to_b < x * x + y * y;
  if (!is_obtuse || distance_across(h) > reach) return false;
  return divide_wall(h, a.x + share * x, a.y + share * y).has_value();
}

//      p -- q        On either side, x is placed about as far from q as p is, and y from x:
//     /|    |.       farther by half of the slack and by all of it. So there is a strip from wall
//    / x -- y .      to wall.
bool VoidMesh::divide_walls_beside(const std::vector<HalfEdge>& sides) {
  struct Bridge {
    HalfEdge side;
    HalfEdge beyond;
    VertexId from;
    VertexId to;
  };
  std::vector<Bridge> bridges;
  bridges.reserve(sides.size());
  for (const HalfEdge h : sides) bridges.push_back({h, twins_[h], corners_[h], corners_[next(h)]});
  const auto is_within = [this](std::uint32_t triangle) { return !is_beyond(triangle); };
  bool has_divided = false;
  for (const Bridge& bridge : bridges) {
    const Point p = points_[bridge.from.value];
    const Point q = points_[bridge.to.value];
    const double length = length_between(p, q);
    for (const bool is_right : {true, false}) {
      const auto divide_at = [&](Point end, Point at, double slack) -> std::optional<Point> {
        const auto side = find_side(bridge.side, bridge.beyond, bridge.from, bridge.to);
        if (!side) return std::nullopt;
        const HalfEdge h = end == p ? *side : twins_[*side];
        const bool goes_before = (end == p) == is_right;
        const auto wall = goes_before ? wall_before(h, is_within) : wall_after(h, is_within);
        return divide_near(wall, end, at, slack * length);
      };
      const std::optional<Point> x = divide_at(p, q, (1 + kSlack) / 2);
      const std::optional<Point> y = divide_at(q, x.value_or(p), kSlack);
      has_divided = has_divided || x || y;
    }
  }
  make_delaunay();
  return has_divided;
}

/// The side from one vertex to the other, which was one of these two or their twins before walls
/// were split; none if it is at neither place any more.
std::optional<VoidMesh::HalfEdge> VoidMesh::find_side(HalfEdge side, HalfEdge beyond, VertexId from,
                                                      VertexId to) const {
  if (!is_wall(side) && corners_[side] == from && corners_[next(side)] == to) return side;
  if (!is_wall(beyond) && corners_[beyond] == to && corners_[next(beyond)] == from) {
    return twins_[beyond];
  }
  return std::nullopt;
}

/// Splits a wall that leads from or to p at the point that is `reach` away from q, and returns that
/// point.
std::optional<Point> VoidMesh::divide_near(std::optional<HalfEdge> wall, Point p, Point q,
                                           double reach) {
  if (!wall) return std::nullopt;
  const double wall_length = length(*wall);
  const Point r = corner(*wall) == p ? corner(next(*wall)) : corner(*wall);
  const double x = (static_cast<double>(r.x) - p.x) / wall_length;
  const double y = (static_cast<double>(r.y) - p.y) / wall_length;
  const double to_q_x = static_cast<double>(q.x) - p.x;
  const double to_q_y = static_cast<double>(q.y) - p.y;
  const double along = to_q_x * x + to_q_y * y;
  const double across = to_q_x * y - to_q_y * x;
  const double from_p = along + std::sqrt(std::max(0.0, reach * reach - across * across));
  if (from_p >= wall_length) return std::nullopt;
  return divide_wall(*wall, p.x + from_p * x, p.y + from_p * y);
}

//          c                 c
//         / \               /|\      f lies on ab or, rounded, above it: the polygon below gets the
//        /   \      ->     / | \     triangle afb, which contains no vertex
//       a-----b           a--f--b
std::optional<Point> VoidMesh::divide_wall(HalfEdge h, double x, double y) {
  const Point a = corner(h);
  const Point b = corner(next(h));
  const Point c = corner(before(h));
  const Point near{static_cast<std::int32_t>(std::floor(x)),
                   static_cast<std::int32_t>(std::floor(y))};
  Point foot = a;
  std::int64_t least = 0;
  for (const Point p : {near, Point{near.x + 1, near.y}, Point{near.x, near.y + 1},
                        Point{near.x + 1, near.y + 1}}) {
    const std::int64_t off = orientation(a, b, p);
    const bool is_within = off >= 0 && orientation(b, c, p) > 0 && orientation(c, a, p) > 0;
    if (!is_within || (foot != a && off >= least)) continue;
    foot = p;
    least = off;
  }
  if (foot == a) return std::nullopt;
  has_failed_ = has_failed_ || corners_.size() + 3 > kWallBit;
  if (has_failed_) return std::nullopt;

  const VertexId f(points_.size());
  points_.push_back(foot);
  const EdgeId edge = edge_of(h);
  const VertexId to = corners_[next(h)];
  const VertexId apex = corners_[before(h)];
  const std::uint32_t beyond = twins_[next(h)];
  const HalfEdge u = 3 * add_triangle(f, to, apex);
  corners_[next(h)] = f;
  set_twin(u, wall_of(edge));
  set_twin(u + 1, beyond);
  set_twin(u + 2, next(h));
  suspects_.insert(suspects_.end(), {before(h), u + 1, u + 2});
  return foot;
}

}  // namespace trapeze
