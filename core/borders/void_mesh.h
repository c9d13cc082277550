// A mesh of triangles of the void between the polygons of a coverage: what lies outside, up to the
// convex hull of all.
//
// The trapezoids of the void are parted by the lines between their top and bottom vertices into
// polygons with one straight side, these into triangles, and edges are exchanged (Lawson) until the
// triangulation is the constrained Delaunay one: no circle around a triangle holds a vertex that is
// seen from it. So it depends on the shape of the void only, and not on the direction of the sweep,
// but for four vertices on one circle. All predicates are exact.
//
// Beyond the hull lie triangles with one vertex in common that stands for infinity.
//
// Thread-safety: one thread at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/graph/trapezoidal_graph.h"
#include "core/grid/grid.h"
#include "core/grid/ids.h"

namespace trapeze {

class VoidMesh {
 public:
  /// A side of a triangle: 3 * triangle + (0 .. 2). It leads from that corner to the next one, and
  /// the triangle lies to its right as seen on the map.
  using HalfEdge = std::uint32_t;

  /// Of the graph of a coverage as it was built, which must outlive the mesh.
  explicit VoidMesh(const TrapezoidalGraph& graph);

  /// Whether there were too many exchanges of edges: there is no mesh then.
  bool has_failed() const { return has_failed_; }

  /// Divides edges of polygons where a vertex is near: where the triangle at an edge has an obtuse
  /// angle beyond it, and that corner is at most `reach` cells away, at the foot of the
  /// perpendicular. So of a vertex and an edge that are near each other there is a side that is
  /// hardly longer than they are apart. The foot is rounded to a grid point within the triangle, so
  /// that the polygon grows by less than a cell and nothing comes to cross.
  void divide_walls(double reach);

  /// How much longer than a side the others of the triangles are that divide_walls_beside() makes.
  static constexpr double kSlack = 1.05;
  /// Divides the walls that lead away from both ends of sides between two polygons, so near to them
  /// that a side of at most kSlack times the length leads from the one to the other. Returns
  /// whether it has divided any; the sides may be others afterwards, and some may be left as they
  /// are.
  bool divide_walls_beside(const std::vector<HalfEdge>& sides);

  /// The next wall around the vertex from which the half-edge leads: in the order in which it is in
  /// triangles before itself, a wall that leads to that vertex; in the other one, a wall that leads
  /// from there. None if a triangle for which may_pass(triangle) is false comes before.
  template <typename MayPass>
  std::optional<HalfEdge> wall_before(HalfEdge h, const MayPass& may_pass) const {
    for (HalfEdge at = h; may_pass(triangle_of(at)); at = twins_[before(at)]) {
      if (is_wall(before(at))) return before(at);
    }
    return std::nullopt;
  }
  template <typename MayPass>
  std::optional<HalfEdge> wall_after(HalfEdge h, const MayPass& may_pass) const {
    for (HalfEdge at = twins_[h]; may_pass(triangle_of(at)); at = twins_[next(at)]) {
      if (is_wall(next(at))) return next(at);
    }
    return std::nullopt;
  }

  std::size_t triangle_count() const { return corners_.size() / 3; }
  /// Whether the triangle lies beyond the hull.
  bool is_beyond(std::uint32_t triangle) const;
  Point corner(HalfEdge h) const { return points_[corners_[h].value]; }
  /// The same for vertices of the graph, and numbers from vertices().size() on for feet.
  VertexId vertex(HalfEdge h) const { return corners_[h]; }
  std::size_t vertex_count() const { return points_.size(); }
  static HalfEdge next(HalfEdge h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static HalfEdge before(HalfEdge h) { return h % 3 == 0 ? h + 2 : h - 1; }
  static std::uint32_t triangle_of(HalfEdge h) { return h / 3; }

  /// Whether it is (a piece of) an edge of a polygon.
  bool is_wall(HalfEdge h) const { return (twins_[h] & kWallBit) != 0; }
  /// Of a wall: the edge of the graph.
  EdgeId edge_of(HalfEdge h) const { return walls_[twins_[h] & ~kWallBit].edge; }
  /// Of all others: the same side of the triangle beyond.
  HalfEdge twin(HalfEdge h) const { return twins_[h]; }
  /// The sides of all triangles that are walls: every edge of the graph beside the void, in pieces
  /// if it was divided.
  std::vector<HalfEdge> walls() const;

  /// From the third corner of the triangle to the side, in cells.
  double distance_across(HalfEdge h) const;
  double length(HalfEdge h) const;

 private:
  static constexpr std::uint32_t kWallBit = 0x80000000;
  static constexpr std::uint32_t kUnknown = 0xffffffff;
  static constexpr VertexId kInfinity = VertexId(std::size_t{0});

  struct Wall {
    EdgeId edge;
    HalfEdge half = kUnknown;
  };
  /// What will lie beyond a side that is made later: a half-edge, a wall, or the line through a
  /// node.
  struct Seam {
    enum class Kind : std::uint8_t { half_edge, wall, node } kind = Kind::node;
    std::uint32_t number = kUnknown;
  };

  void triangulate();
  void triangulate_beside(EdgeId e, Side s);
  std::array<std::vector<HalfEdge>, 2> surround();
  void close_hull(const std::array<std::vector<HalfEdge>, 2>& around);
  Seam seam_through(NodeId n, Side beyond) const;
  std::uint32_t add_triangle(VertexId a, VertexId b, VertexId c);
  void connect(HalfEdge h, const Seam& seam);
  void set_twin(HalfEdge h, std::uint32_t beyond);
  std::uint32_t wall_of(EdgeId e);

  void make_delaunay();
  bool is_to_be_exchanged(HalfEdge h) const;
  void exchange(HalfEdge h);
  bool divide_at_foot(std::uint32_t wall, double reach);
  std::optional<Point> divide_near(std::optional<HalfEdge> wall, Point p, Point q, double reach);
  std::optional<HalfEdge> find_side(HalfEdge side, HalfEdge beyond, VertexId from,
                                    VertexId to) const;
  std::optional<Point> divide_wall(HalfEdge h, double x, double y);

  const TrapezoidalGraph& graph_;
  std::vector<Point> points_;
  std::vector<VertexId> corners_;
  std::vector<std::uint32_t> twins_;  // a half-edge, or kWallBit and the number of a wall
  std::vector<Wall> walls_;
  Table<NodeId, HalfEdge> seams_;  // of a node: the side that was made first
  std::vector<HalfEdge> suspects_;
  std::uint64_t exchanges_ = 0;
  bool has_failed_ = false;
};

}  // namespace trapeze
