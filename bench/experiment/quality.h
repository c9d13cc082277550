// What simplified polygons are worth: whether they are valid, how far they are off, and what became
// of their area.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bench/experiment/contestant.h"
#include "core/grid/rings.h"

namespace trapeze::experiment {

/// Of the polygons, or for Trapeze the features, that meet one view.
struct Quality {
  Method method = Method::lifespans;
  Topology topology = Topology::strict;
  double scale = 0;
  std::size_t polygons = 0;  // before; parts of what was simplified together count together
  std::size_t gone = 0;      // of them, too small to be left
  std::size_t invalid = 0;   // of them, by GEOS; or because edges cross
  std::size_t vertices = 0;  // left
  double tolerance = 0;      // cells
  /// Hausdorff distance of boundaries, the greatest of all, of rings that are left; cells.
  double hausdorff = 0;
  /// Absolute changes of area, summed over the polygons, relative to their area.
  double area_error = 0;
};

/// By view: the polygons as the method simplifies them; BLG trees give the same as Douglas-Peucker,
/// and lifespans the same as adapting the graphs of whole features, which is what is looked at. Any
/// number of threads may measure one map.
std::vector<Quality> measure_quality(Method method, Topology topology, const Map& map,
                                     std::span<const ScaledView> views);

/// The discrete Hausdorff distance between rings and what simplification left of them, cells. Only
/// those of the source's rings count of which three vertices are left. As simplified vertices are
/// vertices of the source, it is the greatest distance of one of these from the simplified
/// boundary.
double distance_between(const Rings& source, const Rings& simplified);

/// Whether a shell with its holes, rings `first` .. `last` - 1, is a valid polygon.
bool is_valid_polygon(const Rings& rings, std::size_t first, std::size_t last);

}  // namespace trapeze::experiment
