// A triangle mesh of the void between the polygons of a coverage: the outside, up to the convex
// hull of all polygons.
//
// The lines between the top and bottom vertices of the trapezoids of the void divide it into
// polygons with one straight side. These are divided into triangles, and edges are flipped (Lawson)
// until the triangulation is the constrained Delaunay one: no circumcircle contains a vertex that
// is visible from its triangle. So, except where four vertices lie on one circle, the mesh depends
// only on the shape of the void and not on the direction of the sweep. All predicates are exact.
//
// Beyond the hull lie triangles with one shared vertex that represents infinity.
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

  /// Meshes the void of the graph of a coverage as built; the graph must outlive the mesh.
  explicit VoidMesh(const TrapezoidalGraph& graph);

  /// Whether too many edges had to be flipped, or there are more triangles than half-edges can
  /// number: there is no mesh then.
  bool has_failed() const { return has_failed_; }

  /// Splits edges of polygons near a vertex: where the triangle at an edge has an obtuse angle
  /// opposite it, and that corner is at most `reach` cells away, the edge is split at the foot of
  /// the perpendicular. So a vertex and an edge near each other are joined by a side hardly longer
  /// than their distance. The foot is rounded to a grid point within the triangle, so the polygon
  /// grows by less than a cell and no crossing arises.
  void divide_walls(double reach);

  /// By which factor the sides made by divide_walls_beside() may be longer than the given ones.
  static constexpr double kSlack = 1.05;
  /// Splits the walls that lead away from both ends of sides between two polygons, so near to these
  /// that a side of at most kSlack times the length connects the two walls. Returns whether any
  /// wall was split. The sides may have changed afterwards, and some may have been left as they
  /// were.
  bool divide_walls_beside(const std::vector<HalfEdge>& sides);

  /// The next wall around the vertex from which the half-edge leads. wall_before() turns around the
  /// vertex by steps of before() and finds a wall that leads to that vertex; wall_after() turns the
  /// other way and finds a wall that leads from it. None if a triangle for which may_pass(triangle)
  /// is false comes first.
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
  /// Vertices of the graph keep their ids; feet are numbered from vertices().size() on.
  VertexId vertex(HalfEdge h) const { return corners_[h]; }
  std::size_t vertex_count() const { return points_.size(); }
  static HalfEdge next(HalfEdge h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static HalfEdge before(HalfEdge h) { return h % 3 == 0 ? h + 2 : h - 1; }
  static std::uint32_t triangle_of(HalfEdge h) { return h / 3; }

  /// Whether the side is (a piece of) an edge of a polygon.
  bool is_wall(HalfEdge h) const { return (twins_[h] & kWallBit) != 0; }
  /// The edge of the graph of a wall.
  EdgeId edge_of(HalfEdge h) const { return walls_[twins_[h] & ~kWallBit].edge; }
  /// For sides that are no walls: the same side of the triangle beyond.
  HalfEdge twin(HalfEdge h) const { return twins_[h]; }
  /// The sides of all triangles that are walls: every edge of the graph beside the void, in pieces
  /// if it was split.
  std::vector<HalfEdge> walls() const;

  /// The distance from the third corner of the triangle to the side, in cells.
  double distance_across(HalfEdge h) const;
  double length(HalfEdge h) const;

 private:
  static constexpr std::uint32_t kWallBit = 0x80000000;
  static constexpr std::uint32_t kUnknown = 0xffffffff;
  /// Each vertex adds two triangles, and numbers of half-edges lack a bit. The rest is for feet.
  static constexpr std::size_t kMostVertices = std::size_t{1} << 28;
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
  Table<NodeId, HalfEdge> seams_;  // by node: the side that was made first
  std::vector<HalfEdge> suspects_;
  std::uint64_t exchanges_ = 0;
  bool has_failed_ = false;
};

}  // namespace trapeze
