// Trips over a map: the tiles that somebody asks for who looks at it, and the data sets they go to.
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

/// What of a data set trips need: for every feature the middle of its box, and all vertices.
struct Places {
  std::vector<Point> middles;
  std::vector<Point> vertices;
  Box box;
};

/// Throws std::runtime_error if a file cannot be read.
Places read_places(std::span<const TripLayer> layers);

/// A screen: how large the map is that somebody looks at, in pixels.
struct Screen {
  int width = 1600;
  int height = 1200;
};

/// Of every zoom from `min_zoom` to `max_zoom`, `views` views of a screen around the middles of
/// random features, and of every view the tiles that it shows, row by row. What several views show
/// comes several times.
std::vector<TileId> make_trip(const Places& places, int min_zoom, int max_zoom, int views,
                              Screen screen = {}, std::uint32_t seed = 1);

/// Of every zoom, all tiles that meet the box.
std::vector<TileId> tiles_over(const Box& box, int min_zoom, int max_zoom);

/// Of every zoom, up to `count` different tiles that hold a random vertex each.
std::vector<TileId> tiles_at_vertices(const Places& places, int min_zoom, int max_zoom,
                                      std::size_t count, std::uint32_t seed = 1);

/// A data set and the tiles that are asked of it, one request for all its layers, bottom first.
struct Trip {
  std::string name;
  std::vector<TripLayer> layers;
  std::vector<TileId> tiles;
};

constexpr int kTripViews = 9;  // a zoom: 72 for the eight zooms of a city

/// Three layers of Malta, 72 views of the zooms 10 to 17.
Trip malta_trip(const std::string& data_folder);
/// All tiles of the zooms 0 to 9 that hold buildings of Shenzhen.
Trip shenzhen_from_afar(const std::string& data_folder);
/// Tiles of all zooms that the boundary of one polygon with 488,034 vertices goes through.
Trip usa48_trip(const std::string& data_folder);

/// Any layer of the folder by itself: three views of each of eight zooms, the first one that at
/// which the layer is as wide as a screen.
Trip layer_trip(const std::string& layer, const std::string& data_folder);
/// The layers that there are, in order.
std::vector<std::string> layer_names(const std::string& data_folder);

/// The names of the trips that have one, and the trip of a name, which may also be that of a layer.
/// Throws std::runtime_error for others.
std::vector<std::string> trip_names();
Trip named_trip(const std::string& name, const std::string& data_folder);

/// The folder that the variable TRAPEZE_DATA names. Throws std::runtime_error if it is not set.
std::string real_data_folder();

}  // namespace trapeze
