// Finds the vertex of a piece of a ring that lies farthest from the chord of the piece: the inner
// step of the recursive partitioning (paper, section 3.2).
//
// Examining all vertices of every piece is quadratic where the farthest one is always next to an
// end: a comb with each tooth longer than the one before, a spiral, a long straight staircase. So a
// tree of convex hulls over the vertices is kept: no vertex is farther away than the farthest
// corner of a hull around it, and the vertices in a hull no corner of which is far enough are
// skipped. The result is, bit for bit, that of examining all vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"

namespace trapeze {

/// The distance from a segment, prepared for many points. The segment is taken from its upper end,
/// so that results do not depend on the direction of the ring.
class SegmentDistance {
 public:
  SegmentDistance(Point a, Point b)
      : a_(is_above(a, b) ? a : b),
        b_(is_above(a, b) ? b : a),
        dx_(static_cast<double>(b_.x) - a_.x),
        dy_(static_cast<double>(b_.y) - a_.y),
        squared_length_(dx_ * dx_ + dy_ * dy_),
        inverse_(squared_length_ > 0 ? 1 / squared_length_ : 0) {}

  /// In cells squared; off by less than a millionth of a cell in the distance.
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

  /// No point of a convex hull is farther away: the greatest distance of a corner if it has few of
  /// them, and up to half as much again if not, in logarithmic time. The corners go from the top
  /// along the right side to the bottom and along the left side back.
  double squared_bound(std::span<const Point> hull) const;

 private:
  Point a_, b_;
  double dx_, dy_, squared_length_, inverse_;
};

/// Holds working memory for reuse; one thread at a time.
class FarthestVertex {
 public:
  /// `ring` must outlive its use here.
  void assign(std::span<const Point> ring);

  struct Found {
    std::size_t vertex;  // its index in the piece, so perhaps past the end of the ring
    double squared;      // its distance, in cells squared
  };
  /// Of the vertices begin + 1 .. end - 1 the one farthest from the segment between begin and end;
  /// indices may run past the end of the ring and are taken modulo its length. Of several at the
  /// same distance it is the one nearest to the middle of the piece, then the uppermost, then the
  /// first: a comb of equal teeth is halved instead of being split off tooth by tooth. begin + 1 <
  /// end <= begin + length of the ring.
  Found find(std::size_t begin, std::size_t end);

 private:
  static constexpr std::size_t kLeaf = 64;  // vertices in a hull of the lowest row
  static constexpr std::size_t kMostRows = 32;
  static constexpr std::size_t kMostWithoutTree = 512;  // too few vertices for a tree
  // How often each vertex of a ring is examined before a tree is built: more often than is usual
  // even for a ring of millions of vertices, whose pieces are roughly halved each time.
  static constexpr std::size_t kVisitsBeforeTree = 48;

  /// Convex hulls one after another.
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
    double bound = 0;  // no vertex is farther away, not even by rounding; in cells squared
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
  std::vector<Row> rows_;  // [0]: around kLeaf vertices each; each next around pairs
  std::vector<Point> points_;
};

}  // namespace trapeze
