// Conversions between longitude and latitude (degrees, WGS 84), metres of EPSG:3857, tiles and the
// grid.
#pragma once

#include <cstdint>
#include <numbers>

#include "core/grid/grid.h"

namespace trapeze {

/// Half the side of the Web Mercator square in metres; the square is [-h, h] in x and y.
constexpr double kMercatorHalfSide = 20037508.342789244;
/// The latitude, in degrees, at which the square ends in the north and (negated) in the south.
constexpr double kMaxLatitude = 85.0511287798066;

/// Metres (x east, y north) to cells (x east, y south), not yet rounded. The Web Mercator square
/// becomes [kGridMin, kGridMax] squared; points outside it stay outside.
struct GridPosition {
  double x = 0;
  double y = 0;
};
GridPosition grid_from_metres(double x, double y);
GridPosition metres_from_grid(double x, double y);

/// The length in cells of a length on the ground, at the latitude of `y` (cells): the map scale
/// grows towards the poles.
double cells_from_ground(double metres, double y);

/// Of longitude, and of latitude at the equator.
constexpr double kCellsPerRadian = static_cast<double>(kGridMax) / std::numbers::pi;

struct LonLat {
  double lon = 0;  // degrees east
  double lat = 0;  // degrees north
};
LonLat lonlat_from_grid(double x, double y);
GridPosition grid_from_lonlat(LonLat position);

/// Whether an edge lies where polygons were cut off, so that it is no real boundary: along the
/// antimeridian and the other edges of the square. Source files were often cut there before, and
/// their cuts rounded and simplified: no shore is known beyond 85.045 degrees, but Antarctica often
/// ends at 85.05.
bool is_on_frame(Point a, Point b);

constexpr int kMaxZoom = 24;

/// A tile of the XYZ scheme: 0 <= z <= kMaxZoom, 0 <= x, y < 2^z, y grows southwards.
struct TileId {
  int z = 0;
  std::uint32_t x = 0;
  std::uint32_t y = 0;

  constexpr bool is_valid() const {
    return z >= 0 && z <= kMaxZoom && x < (1u << z) && y < (1u << z);
  }
  /// Side of the tile in cells.
  constexpr std::int64_t side() const { return kGridSize >> z; }
  /// The north-west corner, in cells.
  constexpr std::int64_t origin_x() const {
    return kGridMin + static_cast<std::int64_t>(x) * side();
  }
  constexpr std::int64_t origin_y() const {
    return kGridMin + static_cast<std::int64_t>(y) * side();
  }

  friend constexpr bool operator==(const TileId&, const TileId&) = default;
};

}  // namespace trapeze
