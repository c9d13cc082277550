#include "bench/measure/trip.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "bench/core/source_rings.h"
#include "core/grid/rings.h"

namespace trapeze {
namespace {

constexpr int kTileSide = 256;  // pixels

struct NamedTrip {
  const char* name;
  Trip (*make)(const std::string& data_folder);
};

constexpr NamedTrip kTrips[] = {
    {"malta", malta_trip}, {"shenzhen_z0-9", shenzhen_from_afar}, {"usa48", usa48_trip}};

/// Distinct tiles in the order in which they were first added.
class TileList {
 public:
  void add(const TileId& tile) {
    if (seen_.insert({tile.z, tile.x, tile.y}).second) tiles_.push_back(tile);
  }
  std::size_t size() const { return tiles_.size(); }
  std::vector<TileId> take() { return std::move(tiles_); }

 private:
  std::set<std::tuple<int, std::uint32_t, std::uint32_t>> seen_;
  std::vector<TileId> tiles_;
};

std::int64_t tile_number(std::int64_t cell, int z) {
  return (cell - kGridMin) >> (kGridBits - z);
}

/// Calls `add` for the tiles that contain a part of the rectangle, in cells.
template <typename Add>
void each_tile(int z, std::int64_t min_x, std::int64_t min_y, std::int64_t max_x,
               std::int64_t max_y, const Add& add) {
  const std::int64_t last = (std::int64_t{1} << z) - 1;
  const auto first_column = std::max<std::int64_t>(tile_number(min_x, z), 0);
  const auto first_row = std::max<std::int64_t>(tile_number(min_y, z), 0);
  for (std::int64_t y = first_row; y <= std::min(tile_number(max_y, z), last); ++y) {
    for (std::int64_t x = first_column; x <= std::min(tile_number(max_x, z), last); ++x) {
      add(TileId{z, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)});
    }
  }
}

void append_view(Point middle, int z, Screen screen, std::vector<TileId>& tiles) {
  const std::int64_t pixel = (kGridSize >> z) / kTileSide;
  const std::int64_t half_width = screen.width * pixel / 2;
  const std::int64_t half_height = screen.height * pixel / 2;
  each_tile(z, middle.x - half_width, middle.y - half_height, middle.x + half_width - 1,
            middle.y + half_height - 1, [&](const TileId& tile) { tiles.push_back(tile); });
}

/// Not a distribution of the standard library: these differ between libraries.
Point pick(const std::vector<Point>& points, std::mt19937& random) {
  return points[random() % points.size()];
}

Point middle_of(const Box& box) {
  return {static_cast<std::int32_t>((std::int64_t{box.min_x} + box.max_x) / 2),
          static_cast<std::int32_t>((std::int64_t{box.min_y} + box.max_y) / 2)};
}

}  // namespace

Places read_places(std::span<const TripLayer> layers) {
  Places places;
  for (const TripLayer& layer : layers) {
    for (const Rings& rings : read_source_rings(layer.file)) {
      Box box;
      for (const Point point : rings.points) box.include(point);
      places.middles.push_back(middle_of(box));
      places.vertices.insert(places.vertices.end(), rings.points.begin(), rings.points.end());
      places.box.include(box);
    }
  }
  if (places.middles.empty()) throw std::runtime_error("there are no polygons to go to");
  return places;
}

std::vector<TileId> make_trip(const Places& places, int min_zoom, int max_zoom, int views,
                              Screen screen, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<TileId> tiles;
  for (int z = min_zoom; z <= max_zoom; ++z) {
    for (int view = 0; view < views; ++view) {
      append_view(pick(places.middles, random), z, screen, tiles);
    }
  }
  return tiles;
}

std::vector<TileId> tiles_over(const Box& box, int min_zoom, int max_zoom) {
  TileList tiles;
  for (int z = min_zoom; z <= max_zoom; ++z) {
    each_tile(z, box.min_x, box.min_y, box.max_x, box.max_y,
              [&](const TileId& tile) { tiles.add(tile); });
  }
  return tiles.take();
}

std::vector<TileId> tiles_at_vertices(const Places& places, int min_zoom, int max_zoom,
                                      std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  TileList tiles;
  for (int z = min_zoom; z <= max_zoom; ++z) {
    const std::size_t enough = tiles.size() + count;
    // Low zooms do not have as many tiles: the same ones are found again and again.
    for (std::size_t tries = 0; tries < 4 * count && tiles.size() < enough; ++tries) {
      const Point p = pick(places.vertices, random);
      each_tile(z, p.x, p.y, p.x, p.y, [&](const TileId& tile) { tiles.add(tile); });
    }
  }
  return tiles.take();
}

Trip malta_trip(const std::string& data_folder) {
  Trip trip{"malta",
            {{"malta_landuse", data_folder + "/malta_landuse.fgb", "d9d0b8"},
             {"malta_natural", data_folder + "/malta_natural.fgb", "8fbf7f"},
             {"malta_buildings", data_folder + "/malta_buildings.fgb", "a05040"}},
            {}};
  trip.tiles = make_trip(read_places(trip.layers), 10, 17, kTripViews);
  return trip;
}

Trip shenzhen_from_afar(const std::string& data_folder) {
  Trip trip{"shenzhen_z0-9",
            {{"shenzhen_buildings", data_folder + "/shenzhen_buildings.fgb", "a05040"}},
            {}};
  trip.tiles = tiles_over(read_places(trip.layers).box, 0, 9);
  return trip;
}

Trip usa48_trip(const std::string& data_folder) {
  constexpr int kLastZoom = 22;
  constexpr std::size_t kTilesPerZoom = 6;
  Trip trip{"usa48", {{"usa48_land", data_folder + "/usa48_land.fgb", "8fbf7f"}}, {}};
  trip.tiles = tiles_at_vertices(read_places(trip.layers), 0, kLastZoom, kTilesPerZoom);
  return trip;
}

Trip layer_trip(const std::string& layer, const std::string& data_folder) {
  constexpr int kZooms = 8;
  constexpr int kViews = 3;
  constexpr int kLastZoom = 18;
  Trip trip{layer, {{layer, data_folder + "/" + layer + ".fgb", "a05040"}}, {}};
  const Places places = read_places(trip.layers);
  const std::int64_t width = std::int64_t{places.box.max_x} - places.box.min_x;
  int first = 0;
  while (first < kLastZoom && width * kTileSide < Screen().width * (kGridSize >> first)) ++first;
  trip.tiles = make_trip(places, first, std::min(first + kZooms - 1, kLastZoom), kViews);
  return trip;
}

std::vector<std::string> trip_names() {
  std::vector<std::string> names;
  for (const auto& [name, make] : kTrips) names.emplace_back(name);
  return names;
}

std::vector<std::string> layer_names(const std::string& data_folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(data_folder)) {
    if (entry.path().extension() == ".fgb") names.push_back(entry.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

Trip named_trip(const std::string& name, const std::string& data_folder) {
  for (const auto& [known, make] : kTrips) {
    if (name == known) return make(data_folder);
  }
  if (!std::filesystem::exists(data_folder + "/" + name + ".fgb")) {
    throw std::runtime_error("there is no trip " + name + ", and no such layer in " + data_folder);
  }
  return layer_trip(name, data_folder);
}

std::string real_data_folder() {
  const char* folder = std::getenv("TRAPEZE_DATA");
  if (folder == nullptr || *folder == '\0') {
    throw std::runtime_error("TRAPEZE_DATA does not name the folder of the real polygons");
  }
  return folder;
}

}  // namespace trapeze
