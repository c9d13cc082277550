// The boundary of the faces of meshes at one level, in a part of the plane: the face on either side
// of each edge, the order of edges around a face, and the edges near a place.
//
// Edges between the same two points are one edge, whichever meshes they come from. So layers in
// parts behave like one layer, and polygons that share a wall are neighbours although each was
// built separately.
//
// Sides of edges are numbered: 2 * edge + 1 if the face lies to the east of the edge (on its right,
// in the sense of the mesh), 2 * edge if to the west. A side is traversed so that the face is on
// the side towards which x turns to y: even sides start at the upper end.
//
// Thread-safety: one thread at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/radix_sort.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// A point or a displacement in the plane, in cells.
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
/// Positive if b points to the side of a towards which x turns to y.
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
  using Face = std::uint64_t;  // the piece, and the caller's number of the face in it
  static constexpr Face kNoFace = std::numeric_limits<Face>::max();
  static constexpr std::uint32_t kNone = 0xffffffff;

  static std::uint32_t piece_of(Face face) { return static_cast<std::uint32_t>(face >> 32); }
  static std::uint32_t number_of(Face face) { return static_cast<std::uint32_t>(face); }

  struct Edge {
    Point upper;
    Point lower;
    std::array<Face, 2> faces{kNoFace, kNoFace};  // by side
    bool is_cut = false;                          // where polygons were cut off: it is no boundary

    Vector from() const { return to_vector(upper); }
    Vector way() const { return to_vector(lower) - to_vector(upper); }
  };

  /// Starts over, without any piece.
  void begin();
  /// Starts a piece: subsequent additions belong to that mesh, which must remain valid until
  /// find().
  void begin_piece(const MeshView& mesh);
  /// Adds a trapezoid of a face of the piece.
  void add(const MeshTrapezoid& trapezoid, std::uint32_t face);
  /// Adds one of the sides of a face of the piece, on the right of the edge or on its left. The
  /// edge is not horizontal.
  void add_side(std::uint32_t edge, std::uint32_t face, bool is_right);
  /// Adds a horizontal edge, which is a side of no trapezoid.
  void add_edge(std::uint32_t edge) { sides_.push_back(side_of(edge, kNoFace, 0)); }
  /// Marks an edge, which has been or will be added, as a cut: nothing ends there.
  void add_cut(std::uint32_t edge) { cuts_.push_back(side_of(edge, kNoFace, 0)); }

  /// Determines faces and neighbours within the box and prepares look-ups within about that
  /// distance.
  void find(const Box& box, double distance);

  std::span<const Edge> edges() const { return edges_; }
  Face face_of(std::uint32_t side) const { return edges_[side / 2].faces[side % 2]; }
  /// The number of an edge of a piece; kNone if it has not been added, or the same face lies on
  /// both of its sides.
  std::uint32_t edge_number(std::uint32_t piece, std::uint32_t edge) const;
  /// The next or previous side around the same face; kNone if it is not known.
  std::uint32_t next(std::uint32_t side) const { return next_[side]; }
  std::uint32_t before(std::uint32_t side) const { return before_[side]; }

  /// An edge that is no cut, as passed to look-ups.
  struct Near {
    Point upper;
    Point lower;
    std::uint32_t edge = 0;
    std::array<bool, 2> has_face{};  // by side

    Vector from() const { return to_vector(upper); }
    Vector way() const { return to_vector(lower) - to_vector(upper); }
  };
  /// A suitable first radius of look-ups, in cells of the grid.
  double cell() const { return cell_; }
  /// Calls visit(near) for all edges that intersect the box and possibly for some others; some are
  /// visited several times.
  template <typename Visit>
  void for_each_near(Vector min, Vector max, const Visit& visit) const;
  /// The same for edges that may intersect the path from `from` along `way`, in order from its
  /// start. last() returns up to which fraction of the path edges are still needed; it must not
  /// grow.
  template <typename Visit, typename Last>
  void for_each_along(Vector from, Vector way, const Last& last, const Visit& visit) const;

 private:
  struct Side {
    std::uint64_t upper;  // see order_of()
    std::uint64_t lower;
    Face face;
    std::uint32_t number;  // 0 or 1
    std::uint32_t piece;
    std::uint32_t edge;
  };
  struct End {
    std::uint64_t at;  // see order_of()
    std::uint32_t edge;
    bool is_upper;
  };

  Side side_of(std::uint32_t edge, Face face, std::uint32_t number) const;
  void unite_sides();
  void link();
  void sort(std::vector<KeyedIndex>& items);
  void sort_sides(std::span<const Side> sides, std::vector<KeyedIndex>& places);
  void sort_ends();
  void sort_around(std::span<End> ends) const;
  Point other_end(const End& end) const;
  bool link_around(std::span<const End> ends);
  void index(const Box& box, double distance);
  template <typename Visit>
  void for_each_cell(const Edge& edge, const Visit& visit) const;
  int column_of(double x) const {
    return static_cast<int>(std::clamp((x - corner_.x) * per_cell_, 0.0, columns_ - 1.0));
  }
  int row_of(double y) const {
    return static_cast<int>(std::clamp((y - corner_.y) * per_cell_, 0.0, rows_ - 1.0));
  }
  std::span<const Near> in_cell(int row, int column) const {
    const auto cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                      static_cast<std::size_t>(column);
    const std::uint32_t first = cell == 0 ? 0 : cell_end_[cell - 1];
    return std::span(cell_edges_).subspan(first, cell_end_[cell] - first);
  }

  std::vector<MeshView> meshes_;  // by piece
  std::vector<Side> sides_;
  std::vector<Side> cuts_;
  // Ordered by upper ends, then lower ends: indices of sides_ and of cuts_.
  std::vector<KeyedIndex> side_order_;
  std::vector<KeyedIndex> cut_order_;
  std::vector<Edge> edges_;
  std::vector<KeyedIndex> names_;  // the piece and its edge, with the number
  std::vector<KeyedIndex> lower_ends_;
  std::vector<KeyedIndex> scratch_;
  std::vector<End> ends_;
  std::vector<std::uint32_t> next_;    // by side
  std::vector<std::uint32_t> before_;  // by side
  // Cells of a lattice, by row and column, with the edges that intersect each.
  Vector corner_;
  double cell_ = 1;
  double per_cell_ = 1;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<std::uint32_t> cell_end_;
  std::vector<Near> cell_edges_;
};

template <typename Visit>
void BoundaryMap::for_each_near(Vector min, Vector max, const Visit& visit) const {
  const int last_row = row_of(max.y);
  const int first_column = column_of(min.x);
  const int last_column = column_of(max.x);
  for (int row = row_of(min.y); row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      for (const Near& near : in_cell(row, column)) visit(near);
    }
  }
}

// Visits cells row by row, and column by column within each row, in the direction of the path.
// Edges up to kBeside away count as being in a cell, because numbers are rounded.
template <typename Visit, typename Last>
void BoundaryMap::for_each_along(Vector from, Vector way, const Last& last,
                                 const Visit& visit) const {
  constexpr double kBeside = 1;
  const Vector to = from + way;
  const int down = way.y < 0 ? -1 : 1;
  const int right = way.x < 0 ? -1 : 1;
  const int first_row = row_of(from.y);
  const int last_row = row_of(to.y);
  const double per_x = way.x == 0 ? 0 : 1 / way.x;
  const double per_y = way.y == 0 ? 0 : 1 / way.y;
  // The fraction of the path at which it reaches a line, minus a small margin.
  const auto share_at = [](double line, double at, double per_way, int step) {
    return (line - step * kBeside - at) * per_way;
  };
  for (int row = first_row;; row += down) {
    const double enters_at = corner_.y + (down > 0 ? row : row + 1) * cell_;
    if (row != first_row && share_at(enters_at, from.y, per_y, down) > last()) return;
    const auto x_at = [&](double y) {
      return from.x + way.x * std::clamp((y - from.y) * per_y, 0.0, 1.0);
    };
    const double begin = row == first_row ? from.x : x_at(enters_at);
    const double end = row == last_row ? to.x : x_at(enters_at + down * cell_);
    const int first_column = column_of(begin - right * kBeside);
    const int last_column = column_of(end + right * kBeside);
    for (int column = first_column;; column += right) {
      const double line = corner_.x + (right > 0 ? column : column + 1) * cell_;
      if (column != first_column && share_at(line, from.x, per_x, right) > last()) break;
      for (const Near& near : in_cell(row, column)) visit(near);
      if (column == last_column) break;
    }
    if (row == last_row) return;
  }
}

}  // namespace trapeze
