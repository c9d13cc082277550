// Trips over a map: the tiles requested by a user who looks at it, and the data sets they belong
// to.
//
// The same data and seed give the same trip on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/web_mercator.h"

namespace trapeze {

struct TripLayer {
  std::string name;    // as in URLs
  std::string file;    // its path
  std::string colour;  // rrggbb
};

/// The data needed for trips: the centre of every feature's box, and all vertices.
struct Places {
  std::vector<Point> middles;
  std::vector<Point> vertices;
  Box box;
};

/// Throws std::runtime_error if a file cannot be read.
Places read_places(std::span<const TripLayer> layers);

/// The size of the map on a screen, in pixels.
struct Screen {
  int width = 1600;
  int height = 1200;
};

/// For every zoom from `min_zoom` to `max_zoom`, `views` views of a screen around the centres of
/// random features, and for every view the tiles that it shows, row by row. Tiles that several
/// views show occur several times.
std::vector<TileId> make_trip(const Places& places, int min_zoom, int max_zoom, int views,
                              Screen screen = {}, std::uint32_t seed = 1);

/// For every zoom, all tiles that intersect the box.
std::vector<TileId> tiles_over(const Box& box, int min_zoom, int max_zoom);

/// For every zoom, up to `count` different tiles that contain a random vertex each.
std::vector<TileId> tiles_at_vertices(const Places& places, int min_zoom, int max_zoom,
                                      std::size_t count, std::uint32_t seed = 1);

/// A data set and the tiles requested from it, one request for all of its layers, bottom first.
struct Trip {
  std::string name;
  std::vector<TripLayer> layers;
  std::vector<TileId> tiles;
};

constexpr int kTripViews = 9;  // per zoom: 72 for the eight zooms of a city

/// Three layers of Malta, 72 views at zooms 10 to 17.
Trip malta_trip(const std::string& data_folder);
/// All tiles at zooms 0 to 9 that contain buildings of Shenzhen.
Trip shenzhen_from_afar(const std::string& data_folder);
/// Tiles at all zooms crossed by the boundary of one polygon with 488,034 vertices.
Trip usa48_trip(const std::string& data_folder);

/// Any layer of the folder by itself: three views at each of eight zooms, beginning with the zoom
/// at which the layer is as wide as a screen.
Trip layer_trip(const std::string& layer, const std::string& data_folder);
/// The available layers, in order.
std::vector<std::string> layer_names(const std::string& data_folder);

/// The names of the predefined trips, and the trip with a name, which may also be that of a layer.
/// Throws std::runtime_error for other names.
std::vector<std::string> trip_names();
Trip named_trip(const std::string& name, const std::string& data_folder);

/// The folder named by the variable TRAPEZE_DATA. Throws std::runtime_error if it is not set.
std::string real_data_folder();

}  // namespace trapeze
