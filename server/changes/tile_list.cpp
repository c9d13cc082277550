#include "server/changes/tile_list.h"

#include <spdlog/fmt/fmt.h>

#include <iterator>

namespace trapeze {
namespace {

std::string as_text(std::span<const TileId> tiles) {
  std::string text;
  for (const TileId& tile : tiles) {
    fmt::format_to(std::back_inserter(text), "{}/{}/{}\n", tile.z, tile.x, tile.y);
  }
  return text;
}

std::string as_json(std::span<const TileId> tiles) {
  std::string text = "[";
  for (const TileId& tile : tiles) {
    fmt::format_to(std::back_inserter(text), "{}\"{}/{}/{}\"", text.size() > 1 ? "," : "", tile.z,
                   tile.x, tile.y);
  }
  return text + "]\n";
}

std::string as_geojson(std::span<const TileId> tiles) {
  std::string text = R"({"type":"FeatureCollection","features":[)";
  const char* before = "\n";
  for (const TileId& tile : tiles) {
    const auto x = static_cast<double>(tile.origin_x());
    const auto y = static_cast<double>(tile.origin_y());
    const auto side = static_cast<double>(tile.side());
    const LonLat north_west = lonlat_from_grid(x, y);
    const LonLat south_east = lonlat_from_grid(x + side, y + side);
    fmt::format_to(std::back_inserter(text),
                   R"({0}{{"type":"Feature","properties":{{"z":{1},"x":{2},"y":{3}}},"geometry":)"
                   R"({{"type":"Polygon","coordinates":[[[{4:.7f},{7:.7f}],[{6:.7f},{7:.7f}],)"
                   R"([{6:.7f},{5:.7f}],[{4:.7f},{5:.7f}],[{4:.7f},{7:.7f}]]]}}}})",
                   before, tile.z, tile.x, tile.y, north_west.lon, north_west.lat, south_east.lon,
                   south_east.lat);
    before = ",\n";
  }
  return text + "\n]}\n";
}

}  // namespace

std::string tile_list(std::span<const TileId> tiles, TileListFormat format) {
  switch (format) {
    case TileListFormat::geojson:
      return as_geojson(tiles);
    case TileListFormat::json:
      return as_json(tiles);
    case TileListFormat::text:
      break;
  }
  return as_text(tiles);
}

}  // namespace trapeze
