// The tiles as the OGC describes them: the registered tile matrix set WebMercatorQuad.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/grid/grid.h"

namespace trapeze {

constexpr std::string_view kTileMatrixSet = "WebMercatorQuad";
constexpr std::string_view kTileMatrixSetUri =
    "http://www.opengis.net/def/tilematrixset/OGC/1.0/WebMercatorQuad";
constexpr std::string_view kTileMatrixSetTitle = "Google Maps Compatible for the World";
constexpr std::string_view kTileCrsUri = "http://www.opengis.net/def/crs/EPSG/0/3857";
constexpr std::string_view kDegreesCrsUri = "http://www.opengis.net/def/crs/OGC/1.3/CRS84";
constexpr std::string_view kTileScaleSetUri =
    "http://www.opengis.net/def/wkss/OGC/1.0/GoogleMapsCompatible";

/// Metres on the ground of the equator that a pixel shows.
double cell_size(int zoom);
/// For pixels of 0.28 mm, which is what the OGC takes them for.
double scale_denominator(int zoom);

/// The tiles of a zoom that a box touches, first and last.
struct TileLimits {
  std::uint32_t min_row = 0;
  std::uint32_t max_row = 0;
  std::uint32_t min_column = 0;
  std::uint32_t max_column = 0;
};

/// The box is not empty.
TileLimits tile_limits(const Box& box, int zoom);

}  // namespace trapeze
