// The summary of a layer, or of several layers served together, for documents: titles, bounds,
// zooms.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/web_mercator.h"
#include "server/base/result.h"
#include "server/data/dataset.h"

namespace trapeze {

/// West, south, east, north in degrees, to about a centimetre.
using GeographicBounds = std::array<double, 4>;

constexpr GeographicBounds kWorldBounds = {-180, -kMaxLatitude, 180, kMaxLatitude};

/// Rounded to about a centimetre, the resolution of the grid, to keep the text short.
double round_degrees(double degrees);

/// The box must not be empty.
GeographicBounds bounds_in_degrees(const Box& box);

struct LayerSummary {
  std::string title;  // of all layers, comma-separated, no duplicates; as the next two
  std::string description;
  std::string attribution;
  Box box;  // empty if no layer has polygons
  int min_zoom = kMaxZoom;
  int max_zoom = 0;
  std::optional<int> detail_zoom;  // the least known of the layers: accurate up to there

  /// The bounds of the world if there are no polygons.
  GeographicBounds bounds() const;
};

/// The problem is 404 for a name that is not in the dataset.
Result<LayerSummary> summarize_layers(std::span<const std::string> names, const Dataset& dataset);

/// The narrowest strip of longitudes, in degrees, that holds all polygons of the layers, to about a
/// tenth of a degree where it goes over the antimeridian: then its east is greater than 180. Small
/// polygons may be left out as they are at zoom 0. The world if there is nothing. `names` are in
/// the dataset.
struct LongitudeStrip {
  double west = -180;
  double east = 180;
};
LongitudeStrip strip_around_layers(std::span<const std::string> names, const Dataset& dataset);

/// The problem to answer with for a layer name that is not in the dataset.
Problem unknown_layer(const std::string& name, const Dataset& dataset);

}  // namespace trapeze
