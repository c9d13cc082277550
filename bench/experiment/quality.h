// The quality of simplified polygons: validity, deviation, and change of area.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bench/experiment/contestant.h"
#include "core/grid/rings.h"

namespace trapeze::experiment {

/// For the polygons, or for Trapeze the features, that intersect one view.
struct Quality {
  Method method = Method::lifespans;
  Topology topology = Topology::strict;
  double scale = 0;
  std::size_t polygons = 0;  // before; polygons simplified together count as one
  std::size_t gone = 0;      // removed because they were too small
  std::size_t invalid = 0;   // according to GEOS, or because edges cross
  std::size_t vertices = 0;  // remaining
  double tolerance = 0;      // cells
  /// The greatest Hausdorff distance between boundaries of remaining rings; cells.
  double hausdorff = 0;
  /// Absolute changes of area, summed over the polygons, relative to their area.
  double area_error = 0;
};

/// By view: the polygons as the method simplifies them. BLG trees give the same as Douglas-Peucker,
/// and lifespans the same as adapting the graphs of whole features, which is measured instead. Any
/// number of threads may measure one map.
std::vector<Quality> measure_quality(Method method, Topology topology, const Map& map,
                                     std::span<const ScaledView> views);

/// The discrete Hausdorff distance between rings and their simplification, in cells. Only rings of
/// the source with three remaining vertices count. As simplified vertices are vertices of the
/// source, it is the greatest distance of one of the source's vertices from the simplified
/// boundary.
double distance_between(const Rings& source, const Rings& simplified);

/// Whether a shell with its holes, rings `first` .. `last` - 1, is a valid polygon.
bool is_valid_polygon(const Rings& rings, std::size_t first, std::size_t last);

}  // namespace trapeze::experiment
