// Corners of the boundary of a mesh at one level, rounded for drawing.
//
// A corner is a vertex at which two edges end, and no others. It is rounded within its triangle,
// which it has in common with a point on each of the edges: so far from the vertex as is asked for,
// and no farther than the middle of the edge. The curve is the parabola that touches both edges in
// these points, as a few chords.
//
//            v                 Where the triangle holds no other vertex of the boundary, no edge
//           /^\                enters it: see "When a vertex may be removed" in core/README.md. And
//          / | \               no other triangle does: of two that have a place in common, neither
//         / .-. \              with a vertex in the other, an edge of one would have to cross the
//        /.'   '.\             third side of the other, and could not leave again. So nothing
//     a1*---------*a2          comes to cross or to touch. A corner whose triangle holds a vertex
//      /           \           stays as it is.
//
// The place between the corner and the curve goes from the face on the inside of the angle to that
// on its outside: it is less of one and as much more of the other, so that neighbours go on filling
// the plane without gaps, to the last bit.
//
// Which corners are rounded, and how, does not depend on what else has been added, as long as there
// is everything within the radius of them. Where that is not so, it is left to chance: find() is
// told where to look for corners, and those elsewhere stay as they are.
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
    Box tips{kGridMin, kGridMin, kGridMax, kGridMax};  // in which corners lie that are rounded
  };

  struct Corner {
    std::uint32_t piece = 0;
    std::uint32_t vertex = 0;
    std::array<std::uint32_t, 2> edges{};
    std::array<double, 2> shares{};  // of each edge, how much of it is rounded away
    std::uint32_t inside = kNoFace;  // the face within the angle
    std::uint32_t outside = kNoFace;
    Point tip;
    // The curve from the first edge to the second, an odd number of points.
    std::uint32_t first_point = 0;
    std::uint32_t point_count = 0;
  };

  /// Begins anew, without a piece.
  void begin();
  /// What is added next is of that mesh, which has vertices of its own. It stays until find().
  void begin_piece(const MeshView& mesh);
  /// A trapezoid of a face: less than kNoFace, any number. A sharp one leaves the corners at its
  /// edges as they are.
  void add(const MeshTrapezoid& trapezoid, std::uint32_t face, bool is_sharp);
  /// One of the sides of a face, on the right of the edge or on its left; the edge is not
  /// horizontal.
  void add_side(std::uint32_t edge, std::uint32_t face, bool is_right, bool is_sharp);
  /// An edge that is a side of no trapezoid, being horizontal; or one that is known, to make it
  /// sharp.
  void add_edge(std::uint32_t edge, bool is_sharp);

  /// Finds the corners to round.
  void find(const Size& size);

  /// By piece and vertex.
  std::span<const Corner> corners() const { return corners_; }
  /// Null if the vertex stays as it is.
  const Corner* corner_at(std::uint32_t piece, std::uint32_t vertex) const;
  /// Corners that stay as they are after all, at these vertices, in ascending order. Others do not
  /// change.
  void leave_sharp(std::uint32_t piece, std::span<const std::uint32_t> vertices);
  std::span<const Point> points_of(const Corner& corner) const {
    return std::span(points_).subspan(corner.first_point, corner.point_count);
  }
  /// The way of an edge of that piece from its upper end to its lower one, with the halves of the
  /// curves at both. Replaces `way`.
  void trace(std::uint32_t piece, const MeshView& mesh, std::uint32_t edge,
             std::vector<PlateCarreeMesh::PointOnWay>& way) const;

  /// Appends the place between the corner and its curve; as a hole, its area is negative.
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
