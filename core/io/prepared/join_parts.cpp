#include "core/io/prepared/join_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/grid/tolerance.h"
#include "core/grid/web_mercator.h"
#include "core/layer/overview.h"

namespace trapeze {
namespace {

constexpr int kTilePixels = 256;
constexpr double kPixelsOfTolerance = 4;  // the usual tolerance is a quarter of a pixel

/// The mean number of boxes intersected by a tile that intersects any; 0 if there are too many
/// tiles to compute it.
double boxes_of_tile(std::span<const Box> boxes, int zoom) {
  constexpr std::size_t kMostTiles = std::size_t{1} << 20;
  const std::int64_t side = TileId{zoom, 0, 0}.side();
  const std::int64_t last = (std::int64_t{1} << zoom) - 1;
  const auto tile_at = [&](std::int32_t v) {
    return std::clamp<std::int64_t>((v - std::int64_t{kGridMin}) / side, 0, last);
  };
  std::vector<std::uint64_t> tiles;
  for (const Box& box : boxes) {
    if (box.is_empty()) continue;
    const std::int64_t west = tile_at(box.min_x);
    const std::int64_t east = tile_at(box.max_x);
    const std::int64_t north = tile_at(box.min_y);
    const std::int64_t south = tile_at(box.max_y);
    const auto more =
        static_cast<std::size_t>(east - west + 1) * static_cast<std::size_t>(south - north + 1);
    if (tiles.size() + more > kMostTiles) return 0;
    for (std::int64_t y = north; y <= south; ++y) {
      for (std::int64_t x = west; x <= east; ++x) {
        tiles.push_back(static_cast<std::uint64_t>(y) << 32 | static_cast<std::uint64_t>(x));
      }
    }
  }
  if (tiles.empty()) return 0;
  const auto meetings = static_cast<double>(tiles.size());
  std::ranges::sort(tiles);
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  return meetings / static_cast<double>(tiles.size());
}

}  // namespace

int last_zoom_of_overview(std::span<const Box> boxes) {
  constexpr double kFew = 4;
  // Beyond it an overview would be nearly as large as the layer.
  constexpr int kLastZoom = 14;
  int zoom = 0;
  while (zoom < kLastZoom && boxes_of_tile(boxes, zoom + 1) > kFew) ++zoom;
  return zoom;
}

LoadedLayer overview_of(const std::vector<std::shared_ptr<const PreparedPart>>& parts,
                        const std::function<void(double)>& progress) {
  std::vector<Box> boxes;
  boxes.reserve(parts.size());
  for (const auto& part : parts) boxes.push_back(part->summary().bounds);
  const int zoom = last_zoom_of_overview(boxes);
  const double pixel = static_cast<double>(TileId{zoom, 0, 0}.side()) / kTilePixels;  // in cells
  PartNumber number = parts.front()->number();
  number.number = 0;
  number.revision_of_parts = revision_of_parts(parts);
  number.first_level = nearest_level(pixel / kPixelsOfTolerance);

  OverviewBuilder builder(number.first_level);
  std::size_t done = 0;
  for (const auto& part : parts) {
    builder.add(*open_summarized_layer(part->path(), part->summary()).layer);
    if (progress) progress(static_cast<double>(++done) / static_cast<double>(parts.size()));
  }
  LoadedLayer loaded;
  loaded.layer = builder.finish();
  loaded.report.driver = parts.front()->summary().report.driver;
  loaded.report.loaded = loaded.report.features = loaded.layer->features().size();
  loaded.report.vertices = loaded.layer->size().vertices;
  loaded.part = number;
  return loaded;
}

}  // namespace trapeze
