// Projects rings of longitudes and latitudes to the grid of a reference system.
//
// One thread only.
#pragma once

#include <memory>
#include <vector>

#include "core/io/source/clip_ring.h"
#include "core/io/source/cut_edges.h"
#include "core/io/source/target_grid.h"

namespace trapeze {

class GridRings {
 public:
  /// Maximum deviation of an edge from its drawn position, on the ground: a quarter of a cell of
  /// Web Mercator at the equator, or of the grid if its cells are larger.
  static constexpr double kMostOffMetres = 40'075'016.68 / (1u << 31) / 4;

  explicit GridRings(std::shared_ptr<const TargetGrid> grid);

  const TargetGrid& grid() const { return *grid_; }

  /// Replaces `made` by the parts of a ring in degrees that the grid shows, in cells and within the
  /// grid. Edges are straight lines in degrees. A ring along the antimeridian is cut at the same
  /// places on either side of it, so areas on both sides meet. False if a part cannot be projected.
  bool project(const PositionRing& ring, std::vector<PositionRing>& made);

 private:
  bool project_part(PositionRing part, std::vector<PositionRing>& made);

  std::shared_ptr<const TargetGrid> grid_;
  GridTransform transform_;
  double most_off_;  // cells
  PositionRing scratch_;
};

}  // namespace trapeze
