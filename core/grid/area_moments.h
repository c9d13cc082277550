// Where an area lies: its centroid and second moments, and the rectangle that has the same.
#pragma once

#include "core/grid/grid.h"

namespace trapeze {

struct Axis {
  Point from;
  Point to;
};

/// Of a piece of the plane.
struct AreaMoments {
  double area = 0;  // cells squared
  double x = 0;     // of the centroid, in cells
  double y = 0;
  // Integrals over the area of squares and products of distances from the centroid.
  double xx = 0;
  double xy = 0;
  double yy = 0;
  Box box = {};  // around it; empty if it is not known

  /// Adds a piece beside this one.
  void unite(const AreaMoments& other);

  /// The middle line, lengthwise, of a rectangle: its length is that of a rectangle of the same
  /// area and greatest second moment, in the same place and direction; so its width, the area over
  /// its length, is that of a straight strip. Of needles, such a rectangle sticks out at the thick
  /// end: the line does not leave the box. Ends are rounded to cells and lie on the grid.
  Axis axis() const;

  /// Whether the area fills its place: the rectangle that has both second moments is no more than
  /// half as large again as the area. True of convex shapes, and of straight strips; false of
  /// hooks and rings.
  bool is_compact() const;
};

/// Sums the moments of an area from its boundary, in any order of its edges. Exact to about 2^-50
/// of the extent of the boundary, wherever it lies.
class BoundaryMoments {
 public:
  BoundaryMoments() = default;
  /// `origin` is a point on or near the boundary.
  explicit BoundaryMoments(Point origin) : origin_(origin) {}

  /// The area lies on the same side of all edges that are added.
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
