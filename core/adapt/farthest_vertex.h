// Finds the vertex of a piece of a ring that is farthest from the chord of the piece: the inner
// step of the recursive partitioning (paper, section 3.2).
//
// Examining all vertices of every piece is quadratic if the farthest one is always next to an end:
// a comb with each tooth longer than the one before, a spiral, a long straight staircase. To avoid
// this, a tree of convex hulls is kept over the vertices. No vertex is farther away than the
// farthest corner of a hull around it, so vertices in a hull without a corner far enough away are
// skipped. The result is, bit for bit, that of examining all vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"

namespace trapeze {

/// The distance from a segment, prepared for many points. It is computed from the segment's upper
/// end, so results do not depend on the direction of the ring.
class SegmentDistance {
 public:
  SegmentDistance(Point a, Point b)
      : a_(is_above(a, b) ? a : b),
        b_(is_above(a, b) ? b : a),
        dx_(static_cast<double>(b_.x) - a_.x),
        dy_(static_cast<double>(b_.y) - a_.y),
        squared_length_(dx_ * dx_ + dy_ * dy_),
        inverse_(squared_length_ > 0 ? 1 / squared_length_ : 0) {}

  /// In cells squared; the distance is off by less than a millionth of a cell.
  double squared(Point p) const {
    const double px = static_cast<double>(p.x) - a_.x;
    const double py = static_cast<double>(p.y) - a_.y;
    const double along = px * dx_ + py * dy_;
    if (along <= 0) return px * px + py * py;
    if (along >= squared_length_) {
      const double qx = static_cast<double>(p.x) - b_.x;
      const double qy = static_cast<double>(p.y) - b_.y;
      return qx * qx + qy * qy;
    }
    const double across = dx_ * py - dy_ * px;
    return across * across * inverse_;
  }

  /// An upper bound of the distance of all points of a convex hull: exact (the farthest corner) if
  /// the hull has few corners; otherwise found in logarithmic time and up to half as much again.
  /// The corners run from the top along the right side to the bottom and back along the left side.
  double squared_bound(std::span<const Point> hull) const;

 private:
  Point a_, b_;
  double dx_, dy_, squared_length_, inverse_;
};

/// Holds working memory for reuse. One thread at a time.
class FarthestVertex {
 public:
  /// `ring` must outlive its use here.
  void assign(std::span<const Point> ring);

  struct Found {
    std::size_t vertex;  // its index in the piece, which may run past the end of the ring
    double squared;      // its distance, in cells squared
  };
  /// The vertex among begin + 1 .. end - 1 that is farthest from the segment between begin and end.
  /// Indices may run past the end of the ring and are taken modulo its length. Ties go to the
  /// vertex nearest to the middle of the piece, then the uppermost, then the first: a comb of equal
  /// teeth is halved instead of being split off tooth by tooth. Precondition: begin + 1 < end <=
  /// begin + length of the ring.
  Found find(std::size_t begin, std::size_t end);

 private:
  static constexpr std::size_t kLeaf = 64;  // vertices in a hull of the lowest row
  static constexpr std::size_t kMostRows = 32;
  static constexpr std::size_t kMostWithoutTree = 512;  // rings of up to so many vertices get no
                                                        // tree
  // How often each vertex of a ring is examined before a tree is built: more often than usual even
  // for a ring of millions of vertices, whose pieces are roughly halved each time.
  static constexpr std::size_t kVisitsBeforeTree = 48;

  /// Convex hulls, stored one after another.
  struct Row {
    std::vector<Point> corners;
    std::vector<std::uint32_t> ends;

    std::size_t size() const { return ends.size(); }
    std::span<const Point> operator[](std::size_t i) const {
      const std::size_t begin = i == 0 ? 0 : ends[i - 1];
      return std::span<const Point>(corners).subspan(begin, ends[i] - begin);
    }
  };

  struct Search;
  struct TreeNode {
    std::size_t row = 0;
    std::size_t index = 0;
    double bound = 0;  // no vertex is farther away, even allowing for rounding; in cells squared
  };
  Point at(std::size_t i) const { return ring_[i < ring_.size() ? i : i - ring_.size()]; }
  void build_tree();
  void append_hull(Row& row);
  void examine_all(std::size_t begin, std::size_t end, Search& search) const;
  bool wins_tie(std::size_t i, const Search& search) const;
  void search_range(std::size_t begin, std::size_t end, std::size_t lap, Search& search) const;
  TreeNode node(std::size_t row, std::size_t index, const Search& search) const;
  void descend(const TreeNode& parent, Search& search) const;

  std::span<const Point> ring_;
  std::size_t visits_ = 0;  // vertices examined since the ring was assigned
  bool has_tree_ = false;
  std::vector<Row> rows_;  // [0]: hulls around kLeaf vertices each; each next row: around pairs
  std::vector<Point> points_;
};

}  // namespace trapeze
