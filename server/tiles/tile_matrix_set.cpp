#include "server/tiles/tile_matrix_set.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "server/base/nearest_name.h"
#include "server/tiles/map_window.h"

namespace trapeze {
namespace {

constexpr double kRounding = 1e-9;  // of a tile: rounding error at a border

/// Sets in which every matrix has pixels half as large as the one before.
TileMatrixSetPtr quad_tree(TileMatrixSet set, std::uint32_t columns, int last) {
  const double half = set.system->half_side;
  const double side = 2 * half / columns;  // of a tile of the first matrix
  const double north = set.system->is_in_degrees ? half / 2 : half;
  for (int z = 0; z <= last; ++z) {
    TileMatrix matrix;
    matrix.id = std::to_string(z);
    matrix.cell_size = side / kTilePixels / std::exp2(z);
    matrix.scale_denominator = matrix.cell_size * set.system->metres_per_unit / kMetresPerPixel;
    matrix.west = -half;
    matrix.origin_y = north;
    matrix.width = columns << z;
    matrix.height = std::uint32_t{1} << z;
    set.matrices.push_back(std::move(matrix));
  }
  return std::make_shared<const TileMatrixSet>(std::move(set));
}

/// The same for a square of a plane.
TileMatrixSetPtr quad_tree_of(TileMatrixSet set, double west, double north, double cell_size,
                              int last) {
  for (int z = 0; z <= last; ++z) {
    TileMatrix matrix;
    matrix.id = std::to_string(z);
    matrix.cell_size = cell_size / std::exp2(z);
    matrix.scale_denominator = matrix.cell_size * set.system->metres_per_unit / kMetresPerPixel;
    matrix.west = west;
    matrix.origin_y = north;
    matrix.width = matrix.height = std::uint32_t{1} << z;
    set.matrices.push_back(std::move(matrix));
  }
  return std::make_shared<const TileMatrixSet>(std::move(set));
}

std::string uri_of_set(const std::string& id) {
  return "http://www.opengis.net/def/tilematrixset/OGC/1.0/" + id;
}

TileMatrixSetPtr european_laea_quad() {
  const std::string id = "EuropeanETRS89_LAEAQuad";
  return quad_tree_of({id,
                       "Lambert Azimuthal Equal Area ETRS89 for Europe",
                       uri_of_set(id),
                       "",
                       map_system_of_grid("EPSG:3035"),
                       {}},
                      2'000'000, 5'500'000, 17'578.125, 15);
}

// The square of Universal Polar Stereographic as registered by the OGC: far larger than the area of
// use of the reference system.
TileMatrixSetPtr polar_quad(const std::string& id, const std::string& title,
                            const std::string& grid) {
  constexpr double kMiddle = 2'000'000;  // the false easting and northing of the pole
  constexpr double kHalfSide = 16'440'759.350252;
  return quad_tree_of({id, title, uri_of_set(id), "", map_system_of_grid(grid), {}},
                      kMiddle - kHalfSide, kMiddle + kHalfSide, 2 * kHalfSide / kTilePixels,
                      kMaxZoom);
}

}  // namespace

double TileMatrix::zoom() const {
  constexpr double kOfZoom0 = 2 * kMercatorHalfSide / kTilePixels / kMetresPerPixel;
  return snapped_zoom(std::log2(kOfZoom0 / scale_denominator));
}

const TileMatrix* TileMatrixSet::find(std::string_view id_of_matrix) const {
  const auto found = std::ranges::find(matrices, id_of_matrix, &TileMatrix::id);
  return found == matrices.end() ? nullptr : &*found;
}

bool TileMatrixSet::has(const TileId& tile) const {
  if (tile.z < 0 || static_cast<std::size_t>(tile.z) >= matrices.size()) return false;
  const TileMatrix& matrix = matrices[static_cast<std::size_t>(tile.z)];
  return tile.x < matrix.width && tile.y < matrix.height;
}

bool TileMatrixSet::is_from_north() const {
  return std::ranges::none_of(matrices, &TileMatrix::is_from_south);
}

View TileMatrixSet::view_of(const TileId& tile, int scale) const {
  const TileMatrix& matrix = matrices[static_cast<std::size_t>(tile.z)];
  const double width = matrix.tile_width * matrix.cell_size;
  const double height = matrix.tile_height * matrix.cell_size;
  const double west = matrix.west + tile.x * width;
  const double north = matrix.is_from_south ? matrix.origin_y + (tile.y + 1.0) * height
                                            : matrix.origin_y - tile.y * height;
  const int columns = matrix.tile_width * scale;
  const int rows = matrix.tile_height * scale;
  const SystemBounds bounds{west, north - height, west + width, north};
  if (const auto view = system->view_of(bounds, columns, rows)) return *view;
  // Too far from everything drawn, or too small for the grid: somewhere off it.
  View nothing;
  nothing.origin_x = nothing.origin_y = 2 * kGridSize;
  nothing.width = columns;
  nothing.height = rows;
  nothing.projection = system->projection;
  return nothing;
}

TileLimits TileMatrixSet::limits_of(const Box& box, std::size_t matrix, double pixels) const {
  const TileMatrix& tiles = matrices[matrix];
  if (box.is_empty()) return {0, tiles.height - 1, 0, tiles.width - 1};
  const SystemBounds bounds = system->bounds_of(box);
  const double margin = pixels * tiles.cell_size;
  const auto tile_at = [](double distance, double side, std::uint32_t count) {
    const double tile = std::floor(distance / side + kRounding);
    return static_cast<std::uint32_t>(std::clamp(tile, 0.0, count - 1.0));
  };
  const double width = tiles.tile_width * tiles.cell_size;
  const double height = tiles.tile_height * tiles.cell_size;
  const double first =
      tiles.is_from_south ? bounds.south - tiles.origin_y : tiles.origin_y - bounds.north;
  const double last =
      tiles.is_from_south ? bounds.north - tiles.origin_y : tiles.origin_y - bounds.south;
  const std::uint32_t first_row = tile_at(first - margin, height, tiles.height);
  const std::uint32_t last_row = tile_at(last + margin, height, tiles.height);
  // The world repeats: the margin begins again at its other side.
  const bool is_around = system->projection != Projection::plane &&
                         std::max(-bounds.west, bounds.east) + margin > system->half_side;
  if (is_around) return {first_row, last_row, 0, tiles.width - 1};
  return {first_row, last_row, tile_at(bounds.west - margin - tiles.west, width, tiles.width),
          tile_at(bounds.east + margin - tiles.west, width, tiles.width)};
}

const TileMatrixSetPtr& web_mercator_quad() {
  static const TileMatrixSetPtr set =
      quad_tree({"WebMercatorQuad",
                 "Google Maps Compatible for the World",
                 "http://www.opengis.net/def/tilematrixset/OGC/1.0/WebMercatorQuad",
                 "http://www.opengis.net/def/wkss/OGC/1.0/GoogleMapsCompatible",
                 web_mercator(),
                 {}},
                1, kMaxZoom);
  return set;
}

const TileMatrixSetPtr& world_crs84_quad() {
  static const TileMatrixSetPtr set =
      quad_tree({"WorldCRS84Quad",
                 "CRS84 for the World",
                 "http://www.opengis.net/def/tilematrixset/OGC/1.0/WorldCRS84Quad",
                 "http://www.opengis.net/def/wkss/OGC/1.0/GoogleCRS84Quad",
                 crs84(),
                 {}},
                2, kMaxZoom - 1);
  return set;
}

const TileMatrixSets& TileMatrixSets::built_in() {
  static const TileMatrixSets sets = [] {
    TileMatrixSets made;
    made.add(web_mercator_quad());
    made.add(world_crs84_quad());
    const auto add = [&made](const auto& make) {
      try {
        made.add(make());
      } catch (const std::runtime_error& error) {
        spdlog::warn(fmt::format("a tile matrix set is left out: {}", error.what()));
      }
    };
    add([] { return european_laea_quad(); });
    add([] {
      return polar_quad("UPSArcticWGS84Quad",
                        "Universal Polar Stereographic WGS 84 Quad for Arctic", "EPSG:5041");
    });
    add([] {
      return polar_quad("UPSAntarcticWGS84Quad",
                        "Universal Polar Stereographic WGS 84 Quad for Antarctic", "EPSG:5042");
    });
    return made;
  }();
  return sets;
}

void TileMatrixSets::add(TileMatrixSetPtr set) {
  if (find(set->id) != nullptr) {
    throw std::runtime_error(fmt::format("there is another tile matrix set \"{}\"", set->id));
  }
  sets_.push_back(std::move(set));
}

TileMatrixSetPtr TileMatrixSets::find(std::string_view id) const {
  const std::string wanted = in_lower_case(id);
  const auto found = std::ranges::find_if(
      sets_, [&wanted](const auto& set) { return in_lower_case(set->id) == wanted; });
  return found == sets_.end() ? nullptr : *found;
}

std::vector<TileMatrixSetPtr> TileMatrixSets::of(const Dataset& dataset,
                                                 std::string_view layer) const {
  std::vector<TileMatrixSetPtr> sets;
  for (const TileMatrixSetPtr& set : sets_) {
    if (served_in(dataset, layer, *set->system) != nullptr) sets.push_back(set);
  }
  return sets;
}

std::vector<TileMatrixSetPtr> TileMatrixSets::of(const Dataset& dataset) const {
  const std::vector<std::string> grids = dataset.grids();
  std::vector<TileMatrixSetPtr> sets;
  for (const TileMatrixSetPtr& set : sets_) {
    const std::string& grid = set->system->grid;
    if (grid.empty() || std::ranges::find(grids, grid) != grids.end()) sets.push_back(set);
  }
  return sets;
}

std::string names_of(std::span<const TileMatrixSetPtr> sets) {
  std::string names;
  for (const TileMatrixSetPtr& set : sets) names += names.empty() ? set->id : ", " + set->id;
  return names;
}

}  // namespace trapeze
