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
  /// One of the sides of a face of the piece, on the right of the edge or on its left; the edge is
  /// not horizontal.
  void add_side(std::uint32_t edge, std::uint32_t face, bool is_right);
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

  /// An edge that is no cut, as look-ups meet it.
  struct Near {
    Point upper;
    Point lower;
    std::uint32_t edge = 0;
    std::array<bool, 2> has_face{};  // by side

    Vector from() const { return to_vector(upper); }
    Vector way() const { return to_vector(lower) - to_vector(upper); }
  };
  /// About how far look-ups should reach first, in cells of the grid.
  double cell() const { return cell_; }
  /// Calls visit(near) for what may come into the box, at least for what does, some several times.
  template <typename Visit>
  void for_each_near(Vector min, Vector max, const Visit& visit) const;
  /// The same for what may meet a way, from its begin on: last() tells up to which share of it that
  /// is still wanted, and does not grow.
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
  // By their upper ends, then their lower ones: sides_, and cuts_.
  std::vector<KeyedIndex> side_order_;
  std::vector<KeyedIndex> cut_order_;
  std::vector<Edge> edges_;
  std::vector<KeyedIndex> names_;  // the piece and its edge, and the number
  std::vector<KeyedIndex> lower_ends_;
  std::vector<KeyedIndex> scratch_;
  std::vector<End> ends_;
  std::vector<std::uint32_t> next_;    // by side
  std::vector<std::uint32_t> before_;  // by side
  // Cells of a lattice, by row and column, with the edges that come into each.
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

// Row by row, and column by column within each, as the way goes. Cells are met by what is up to
// kBeside away from them, as numbers are rounded.
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
  // The share of the way at which it comes to a line, and a little less.
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
