// Trapezoids and edges of the grid as drawn in plate carree.
//
// Points are moved to their place there, rounded to cells. Edges so high that they would not be
// straight (see plate_carree.h) are cut at certain rows of the grid, the same in all images of that
// resolution, and trapezoids with them. So neighbours still share their sides, and there are
// neither overlaps nor gaps. A side is never farther from its curve than kMostCurved of a row.
//
// Thread-safety: one thread at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/plate_carree.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

class PlateCarreeMesh {
 public:
  /// The maximum distance of a side from the curve that it represents, in rows of the image.
  static constexpr double kMostCurved = 0.01;

  /// Starts an image whose rows are that many cells of plate carree high, and which shows nothing
  /// of the grid above or below the box.
  void begin(double cells_per_row, const Box& box);

  /// Adds the parts of trapezoids that lie in the box.
  void add(const MeshView& mesh, std::span<const TrapezoidRange> ranges);

  /// Replaces `points` by the points between which an edge, or a piece of one, is drawn, from end
  /// to end, as far as they matter to the box; empty if the edge does not. Their shares of the way
  /// from one end to the other ascend.
  struct PointOnWay {
    Point place;
    double share = 0;
  };
  void cut(Point from, Point to, std::vector<PointOnWay>& points);

  std::span<const Point> vertices() const { return vertices_; }
  std::span<const MeshEdge> edges() const { return edges_; }
  std::span<const MeshTrapezoid> trapezoids() const { return trapezoids_; }

  static Point projected(Point p) { return {p.x, plate_carree_row(p.y)}; }

 private:
  // The two ends of a side, the upper one first.
  struct Side {
    Point upper;
    Point lower;
  };

  void add(const MeshView& mesh, const MeshTrapezoid& trapezoid);
  void append(std::int64_t top, std::int64_t bottom, const Side& left, const Side& right);
  bool is_cut(const Side& side) const;
  Side piece_at(const Side& side, std::int64_t y) const;
  Point on_side(const Side& side, std::int64_t y) const;

  std::int64_t height_ = kGridSize;  // of pieces, a power of two
  std::int64_t north_ = kGridMin;
  std::int64_t south_ = kGridMax;
  std::vector<Point> vertices_;
  std::vector<MeshEdge> edges_;
  std::vector<MeshTrapezoid> trapezoids_;
};

}  // namespace trapeze
