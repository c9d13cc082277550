#include "tests/pictures/real_layers.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>

#include "core/grid/tolerance.h"
#include "core/io/load/load_layer.h"

namespace trapeze::testing {
namespace {

TileId tile_around(Point p, int zoom) {
  const std::int64_t side = kGridSize >> zoom;
  const auto number = [&](std::int32_t cell) {
    const std::int64_t tile = (static_cast<std::int64_t>(cell) - kGridMin) / side;
    return static_cast<std::uint32_t>(std::min(tile, (std::int64_t{1} << zoom) - 1));
  };
  return {zoom, number(p.x), number(p.y)};
}

std::filesystem::path file_of(const std::string& name) {
  return std::filesystem::path(std::getenv("TRAPEZE_DATA")) / (name + ".fgb");
}

}  // namespace

std::vector<std::string> real_layer_names() {
  std::vector<std::string> names;
  if (const char* folder = std::getenv("TRAPEZE_DATA")) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
      if (entry.path().extension() == ".fgb") names.push_back(entry.path().stem().string());
    }
  }
  std::ranges::sort(names);
  if (names.empty()) names.emplace_back(kNoData);
  return names;
}

const RealLayer* real_layer(const std::string& name) {
  if (name == kNoData) return nullptr;
  static std::map<std::string, RealLayer> layers;
  RealLayer& real = layers[name];
  if (real.layer == nullptr) {
    real.layer = load_layer(file_of(name).string()).layer;
    real.outlines = TrueOutlines(*real.layer);
  }
  return &real;
}

std::vector<TileId> tiles_around_vertices(const RealLayer& real, int zoom, int count,
                                          std::uint32_t seed) {
  const std::vector<Point>& points = real.outlines.points();
  std::vector<TileId> tiles;
  if (points.empty()) return tiles;
  std::mt19937 random(seed);
  // Where there are fewer tiles than requested, the loop continues with repeated tiles until those
  // with few vertices have occurred too.
  for (int i = 0; i < 256 * count && static_cast<int>(tiles.size()) < count; ++i) {
    // No std distribution is used: these differ between standard libraries.
    const TileId tile = tile_around(points[random() % points.size()], zoom);
    if (std::ranges::find(tiles, tile) == tiles.end()) tiles.push_back(tile);
  }
  return tiles;
}

std::string text_of(const TileId& tile) {
  return std::to_string(tile.z) + "/" + std::to_string(tile.x) + "/" + std::to_string(tile.y);
}

Layer::Selection default_selection(const View& view) {
  const Level level = nearest_level(view.cells_per_pixel / 4);
  return {view.box(), level, level, SmallPolygons::dust};
}

}  // namespace trapeze::testing
