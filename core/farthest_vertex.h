// The vertex of a piece of a ring that lies farthest from the chord of the piece: what a recursive
// partitioning (paper, section 3.2) asks again and again.
//
// Looking at all vertices of every piece is quadratic where the farthest one always is next to an
// end: a comb with each tooth longer than the one before, a spiral. So a tree of boxes over the
// vertices is kept, and what lies in a box that is nowhere far enough is not looked at. The answer
// is the same as that of looking at all, bit for bit.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/grid.h"

namespace trapeze {

/// The distance from a segment, prepared for many points. The segment is taken from its upper end,
/// so that results do not depend on the direction of the ring.
class SegmentDistance {
 public:
  SegmentDistance(Point a, Point b) : a_(is_above(a, b) ? a : b), b_(is_above(a, b) ? b : a) {
    dx_ = static_cast<double>(b_.x) - a_.x;
    dy_ = static_cast<double>(b_.y) - a_.y;
    squared_length_ = dx_ * dx_ + dy_ * dy_;
    inverse_ = squared_length_ > 0 ? 1 / squared_length_ : 0;
  }

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

 private:
  Point a_, b_;
  double dx_, dy_, squared_length_, inverse_;
};

/// Reusable memory; one a thread.
class FarthestVertex {
 public:
  /// `ring` must outlive its use here.
  void assign(std::span<const Point> ring);

  struct Found {
    std::size_t vertex;  // its index in the piece, so perhaps past the end of the ring
    double squared;      // its distance, in cells squared
  };
  /// Of the vertices begin + 1 .. end - 1 the one farthest from the segment between begin and end;
  /// indices run past the end of the ring and are taken modulo its length. Of equally distant ones
  /// it is the one nearest the middle of the piece, then the uppermost: a comb of equal teeth is
  /// halved and not peeled tooth by tooth. begin + 1 < end <= begin + length of the ring.
  Found find(std::size_t begin, std::size_t end) const;

 private:
  static constexpr std::size_t kLeaf = 16;        // vertices in a box of the lowest row
  static constexpr std::size_t kFew = 8 * kLeaf;  // not worth a tree

  struct Search;
  Point at(std::size_t i) const { return ring_[i < ring_.size() ? i : i - ring_.size()]; }
  void consider(std::size_t i, Search& search) const;
  void search_range(std::size_t begin, std::size_t end, std::size_t lap, Search& search) const;
  void descend(std::size_t row, std::size_t index, double bound, Search& search) const;
  double bound_of(std::size_t row, std::size_t index, const Search& search) const;

  std::span<const Point> ring_;
  std::vector<std::vector<Box>> rows_;  // [0]: over vertices, kLeaf each; each next over pairs
};

}  // namespace trapeze
