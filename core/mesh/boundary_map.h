// The boundary of the faces of meshes at one level, in a part of the plane: which face lies on
// either side of each edge, which edge follows which around a face, and which edges are near.
//
// Edges between the same two points are one, whichever meshes they come from: so layers in parts
// are as one, and polygons that share a wall are neighbours though each was built by itself.
//
// A side of an edge is numbered: 2 * edge + 1 if the face lies on its right, going from the upper
// end to the lower one that is to the east, and 2 * edge if to the west. Along a side one goes so
// that the face is on the side to which x turns to y: from the upper end on even sides.
//
// Thread-safety: one thread at a time.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// A place or a way on the plane, in cells.
struct Vector {
  double x = 0;
  double y = 0;

  friend constexpr Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vector operator*(Vector a, double by) { return {a.x * by, a.y * by}; }
};

constexpr double dot(Vector a, Vector b) {
  return a.x * b.x + a.y * b.y;
}
/// Positive if b points to the side of a to which x turns to y.
constexpr double cross(Vector a, Vector b) {
  return a.x * b.y - a.y * b.x;
}
inline double length(Vector a) {
  return std::sqrt(dot(a, a));
}
constexpr Vector to_vector(Point p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y)};
}

class BoundaryMap {
 public:
  using Face = std::uint64_t;  // the piece, and what the caller numbers in it
  static constexpr Face kNoFace = std::numeric_limits<Face>::max();
  static constexpr std::uint32_t kNone = 0xffffffff;

  static std::uint32_t piece_of(Face face) { return static_cast<std::uint32_t>(face >> 32); }
  static std::uint32_t number_of(Face face) { return static_cast<std::uint32_t>(face); }

  struct Edge {
    Point upper;
    Point lower;
    std::array<Face, 2> faces{kNoFace, kNoFace};  // by side
    bool is_cut = false;                          // where polygons were cut off: nothing ends there

    Vector from() const { return to_vector(upper); }
    Vector way() const { return to_vector(lower) - to_vector(upper); }
  };

  /// Begins anew, without a piece.
  void begin();
  /// What is added next is of that mesh, which must stay until find().
  void begin_piece(const MeshView& mesh);
  /// A trapezoid of a face of the piece.
  void add(const MeshTrapezoid& trapezoid, std::uint32_t face);
  /// An edge that is a side of no trapezoid, being horizontal.
  void add_edge(std::uint32_t edge) { sides_.push_back(side_of(edge, kNoFace, 0)); }
  /// Nothing ends at the edge, which has been or will be added.
  void add_cut(std::uint32_t edge) { cuts_.push_back(side_of(edge, kNoFace, 0)); }

  /// Finds out what lies where, within the box, for look-ups within about that distance.
  void find(const Box& box, double distance);

  std::span<const Edge> edges() const { return edges_; }
  Face face_of(std::uint32_t side) const { return edges_[side / 2].faces[side % 2]; }
  /// The number of an edge of a piece; kNone if it has not been added, or the same face lies on
  /// both of its sides.
  std::uint32_t edge_number(std::uint32_t piece, std::uint32_t edge) const;
  /// The side that follows, or goes before, around the same face; kNone where that is not known.
  std::uint32_t next(std::uint32_t side) const { return next_[side]; }
  std::uint32_t before(std::uint32_t side) const { return before_[side]; }

  /// Calls visit(edge) for edges that may come into the box, at least those that do, once each.
  template <typename Visit>
  void for_each_near(Vector min, Vector max, const Visit& visit);

 private:
  struct Side {
    Point upper;
    Point lower;
    Face face;
    std::uint32_t number;  // 0 or 1
    std::uint32_t piece;
    std::uint32_t edge;
  };
  struct Name {
    std::uint64_t piece_and_edge;
    std::uint32_t number;
  };
  struct End {
    Point at;
    Point other;
    std::uint32_t edge;
    bool is_upper;
  };

  Side side_of(std::uint32_t edge, Face face, std::uint32_t number) const;
  void unite_sides();
  void link();
  bool link_around(std::span<const End> ends);
  void index(const Box& box, double distance);
  template <typename Visit>
  void for_each_cell(const Edge& edge, const Visit& visit) const;
  int column_of(double x) const;
  int row_of(double y) const;

  std::vector<MeshView> meshes_;  // by piece
  std::vector<Side> sides_;
  std::vector<Side> cuts_;
  std::vector<Edge> edges_;
  std::vector<Name> names_;
  std::vector<End> ends_;
  std::vector<std::uint32_t> next_;    // by side
  std::vector<std::uint32_t> before_;  // by side
  // Cells of a lattice, by row and column, with the edges that come into each.
  Vector corner_;
  double cell_ = 1;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<std::uint32_t> cell_end_;
  std::vector<std::uint32_t> cell_edges_;
  std::vector<std::uint64_t> seen_;  // by edge: the last look-up that met it
  std::uint64_t look_up_ = 0;
};

template <typename Visit>
void BoundaryMap::for_each_near(Vector min, Vector max, const Visit& visit) {
  const std::uint64_t look_up = ++look_up_;
  const int last_row = row_of(max.y);
  const int last_column = column_of(max.x);
  for (int row = row_of(min.y); row <= last_row; ++row) {
    for (int column = column_of(min.x); column <= last_column; ++column) {
      const auto cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                        static_cast<std::size_t>(column);
      for (std::uint32_t i = cell == 0 ? 0 : cell_end_[cell - 1]; i < cell_end_[cell]; ++i) {
        const std::uint32_t edge = cell_edges_[i];
        if (seen_[edge] == look_up) continue;
        seen_[edge] = look_up;
        visit(edge);
      }
    }
  }
}

}  // namespace trapeze
