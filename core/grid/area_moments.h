// Where an area lies: its centroid and second moments, and the rectangle with the same moments.
#pragma once

#include "core/grid/grid.h"

namespace trapeze {

struct Axis {
  Point from;
  Point to;
};

/// Moments of a piece of the plane.
struct AreaMoments {
  double area = 0;  // cells squared
  double x = 0;     // of the centroid, in cells
  double y = 0;
  // Integrals over the area of squares and products of distances from the centroid.
  double xx = 0;
  double xy = 0;
  double yy = 0;
  Box box = {};  // around it; empty if unknown

  /// Adds a disjoint piece to this one.
  void unite(const AreaMoments& other);

  /// The lengthwise centre line of a rectangle. The rectangle has the same area, greatest second
  /// moment, place and direction; so its width, the area divided by its length, is that of a
  /// straight strip. For needles, such a rectangle sticks out at the thick end; the line does not
  /// leave the box. Ends are rounded to cells and lie on the grid.
  Axis axis() const;

  /// Whether the area fills its place: the rectangle with the same two second moments is at most
  /// one and a half times as large as the area. True for convex shapes and straight strips, false
  /// for hooks and rings.
  bool is_compact() const;
};

/// Sums the moments of an area from its boundary; edges may be added in any order. Exact to about
/// 2^-50 of the extent of the boundary, wherever it lies.
class BoundaryMoments {
 public:
  BoundaryMoments() = default;
  /// `origin` is a point on or near the boundary.
  explicit BoundaryMoments(Point origin) : origin_(origin) {}

  /// The area must lie on the same side of all edges that are added.
  void add(Point from, Point to);

  AreaMoments sum() const;

 private:
  Point origin_;
  Box box_;
  double area_ = 0;  // doubled
  double x_ = 0;
  double y_ = 0;
  double xx_ = 0;
  double xy_ = 0;
  double yy_ = 0;
};

}  // namespace trapeze
