// Corners of the boundary of a mesh at one level, rounded for drawing.
//
// A corner is a vertex at which exactly two edges end. It is rounded within the triangle that it
// forms with a point on each of the edges: at the requested distance from the vertex, but no
// farther than the middle of the edge. The curve is the parabola that touches both edges in these
// points, drawn as a few chords.
//
//            v                 If the triangle contains no other vertex of the boundary, no edge
//           /^\                enters it: see "When a vertex may be removed" in core/README.md. Nor
//          / | \               does another triangle: if two triangles overlapped, neither with a
//         / .-. \              vertex in the other, an edge of one would have to cross the third
//        /.'   '.\             side of the other and could not leave again. So no boundaries come
//     a1*---------*a2          to cross or touch. A corner whose triangle contains a vertex stays
//      /           \           sharp.
//
// The area between the corner and the curve is transferred from the face inside the angle to the
// face outside it: one loses exactly what the other gains, so neighbours still fill the plane
// without gaps, to the last bit.
//
// Which corners are rounded, and how, does not depend on what else has been added, provided that
// everything within the radius of them has been. Otherwise the result is arbitrary; so find() takes
// the box in which corners are rounded, and those elsewhere stay sharp.
//
// Thread-safety: one thread at a time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/grid.h"
#include "core/mesh/plate_carree_mesh.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

class CornerRounding {
 public:
  static constexpr std::uint32_t kNoFace = 0xffffffff;

  struct Size {
    double radius = 0;  // how far from a vertex its edges may be rounded, in pixels
    double pixel = 1;   // cells
    Box tips{kGridMin, kGridMin, kGridMax, kGridMax};  // the corners within this box are rounded
  };

  struct Corner {
    std::uint32_t piece = 0;
    std::uint32_t vertex = 0;
    std::array<std::uint32_t, 2> edges{};
    std::array<double, 2> shares{};  // of each edge: the fraction rounded away
    std::uint32_t inside = kNoFace;  // the face within the angle
    std::uint32_t outside = kNoFace;
    Point tip;
    // The curve from the first edge to the second: an odd number of points.
    std::uint32_t first_point = 0;
    std::uint32_t point_count = 0;
  };

  /// Starts over, without any piece.
  void begin();
  /// Starts a piece: subsequent additions belong to that mesh, which has vertices of its own and
  /// must remain valid until find().
  void begin_piece(const MeshView& mesh);
  /// Adds a trapezoid of a face; the face is any number less than kNoFace. A sharp trapezoid leaves
  /// the corners at its edges unchanged.
  void add(const MeshTrapezoid& trapezoid, std::uint32_t face, bool is_sharp);
  /// Adds one of the sides of a face, on the right of the edge or on its left. The edge is not
  /// horizontal.
  void add_side(std::uint32_t edge, std::uint32_t face, bool is_right, bool is_sharp);
  /// Adds a horizontal edge, which is a side of no trapezoid; or makes a known edge sharp.
  void add_edge(std::uint32_t edge, bool is_sharp);

  /// Finds the corners to round.
  void find(const Size& size);

  /// In order of piece and vertex.
  std::span<const Corner> corners() const { return corners_; }
  /// Null if the vertex is not rounded.
  const Corner* corner_at(std::uint32_t piece, std::uint32_t vertex) const;
  /// Makes the corners at these vertices, which are in ascending order, sharp after all. Others do
  /// not change.
  void leave_sharp(std::uint32_t piece, std::span<const std::uint32_t> vertices);
  std::span<const Point> points_of(const Corner& corner) const {
    return std::span(points_).subspan(corner.first_point, corner.point_count);
  }
  /// Replaces `way` by the path of an edge of that piece from its upper end to its lower one, with
  /// the halves of the curves at both ends.
  void trace(std::uint32_t piece, const MeshView& mesh, std::uint32_t edge,
             std::vector<PlateCarreeMesh::PointOnWay>& way) const;

  /// Appends the area between the corner and its curve; as a hole, its area is negative.
  void append_place(const Corner& corner, bool is_hole, std::vector<Point>& vertices,
                    std::vector<MeshEdge>& edges, std::vector<MeshTrapezoid>& trapezoids) const;

 private:
  using VertexKey = std::uint64_t;  // piece and vertex

  struct Side {
    std::uint32_t piece;
    std::uint32_t edge;
    std::uint32_t face;
    bool is_right;  // the face, of the edge
    bool is_sharp;

    auto operator<=>(const Side&) const = default;
  };
  struct Edge {
    std::uint32_t piece = 0;
    std::uint32_t edge = 0;
    VertexKey upper_key = 0;
    VertexKey lower_key = 0;
    Point upper;
    Point lower;
    std::uint32_t left = kNoFace;
    std::uint32_t right = kNoFace;
    bool is_sharp = false;

    bool is_level() const { return upper.y == lower.y; }
  };
  struct End {
    VertexKey key;
    std::uint32_t edge;  // index into edges_

    auto operator<=>(const End&) const = default;
  };
  struct Place {
    std::uint64_t cell;
    Point point;
    VertexKey key;
  };

  void unite_sides();
  void find_places();
  void round_corner(VertexKey key, const Edge& first, const Edge& second, const Size& size);
  bool is_empty(const std::array<Point, 3>& triangle, VertexKey tip) const;
  static std::optional<std::pair<std::uint32_t, std::uint32_t>> faces_beside(const Edge& edge,
                                                                             Point inner);
  std::uint64_t cell_of(std::int64_t x, std::int64_t y) const;

  std::vector<MeshView> meshes_;  // by piece
  std::vector<Side> sides_;
  std::vector<Edge> edges_;
  std::vector<End> ends_;
  std::vector<Place> places_;  // of vertices, by cell
  std::int64_t cell_side_ = 1;
  std::vector<Corner> corners_;
  std::vector<Point> points_;
};

}  // namespace trapeze
