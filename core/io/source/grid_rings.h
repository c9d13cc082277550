// Rings of longitudes and latitudes on the grid of a reference system.
//
// Belongs to one thread.
#pragma once

#include <memory>
#include <vector>

#include "core/io/source/clip_ring.h"
#include "core/io/source/cut_edges.h"
#include "core/io/source/target_grid.h"

namespace trapeze {

class GridRings {
 public:
  /// How far an edge may be from where it is drawn, on the ground: a quarter of a cell of Web
  /// Mercator at the equator, or of the grid if that has larger ones.
  static constexpr double kMostOffMetres = 40'075'016.68 / (1u << 31) / 4;

  explicit GridRings(std::shared_ptr<const TargetGrid> grid);

  const TargetGrid& grid() const { return *grid_; }

  /// The parts of a ring in degrees that the grid shows, in cells and within it: edges are those of
  /// straight lines in degrees. A ring along the antimeridian is cut at the same places whichever
  /// side it is on, so that what lies on both sides meets. Replaces `made`. False if a part has no
  /// place on the plane.
  bool project(const PositionRing& ring, std::vector<PositionRing>& made);

 private:
  bool project_part(PositionRing part, std::vector<PositionRing>& made);

  std::shared_ptr<const TargetGrid> grid_;
  GridTransform transform_;
  double most_off_;  // cells
  PositionRing scratch_;
};

}  // namespace trapeze
