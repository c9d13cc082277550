#include "server/tiles/map_system.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <utility>

#include "core/grid/plate_carree.h"
#include "core/io/source/target_grid.h"
#include "server/base/nearest_name.h"

namespace trapeze {
namespace {

// Per degree at the equator, on the sphere of Web Mercator.
constexpr double kMetresPerDegree = kMercatorHalfSide / 180;

bool is_alike(std::string_view a, std::string_view b) {
  return a.size() == b.size() && in_lower_case(a) == in_lower_case(b);
}

MapSystemPtr make(MapSystem system) {
  return std::make_shared<const MapSystem>(std::move(system));
}

}  // namespace

bool MapSystem::is_called(std::string_view text) const {
  if (text.size() > 2 && text.front() == '[' && text.back() == ']') {
    text = text.substr(1, text.size() - 2);
  }
  return is_alike(text, name) || is_alike(text, uri) || is_alike(text, urn) ||
         std::ranges::any_of(other_names,
                             [text](const std::string& other) { return is_alike(text, other); });
}

GridPosition MapSystem::cells_from(double x, double y) const {
  const double cells_per_unit = static_cast<double>(kGridMax) / half_side;
  return {(x - middle_x) * cells_per_unit, (middle_y - y) * cells_per_unit};
}

GridPosition MapSystem::units_from(double x, double y) const {
  const double cells_per_unit = static_cast<double>(kGridMax) / half_side;
  return {middle_x + x / cells_per_unit, middle_y - y / cells_per_unit};
}

double MapSystem::zoom_of(const View& view, double scale) const {
  const double zoom = trapeze::zoom_of(view, scale);
  if (projection != Projection::plane) return zoom;
  return zoom + std::log2(web_mercator()->metres_per_cell() / metres_per_cell());
}

double MapSystem::cells_at(double zoom) const {
  const double cells = static_cast<double>(kGridSize) / std::exp2(zoom) / kTilePixels;
  if (projection != Projection::plane) return cells;
  return cells * web_mercator()->metres_per_cell() / metres_per_cell();
}

SystemBounds MapSystem::bounds_of(const View& view) const {
  const auto x = static_cast<double>(view.origin_x);
  const auto y = static_cast<double>(view.origin_y);
  const GridPosition from = units_from(x, y + view.height * view.cells_per_row());
  const GridPosition to = units_from(x + view.width * view.cells_per_pixel, y);
  return {from.x, from.y, to.x, to.y};
}

SystemBounds MapSystem::bounds_of(const Box& box) const {
  const auto row = [this](double y) {
    return projection == Projection::plate_carree ? plate_carree_from_mercator(y) : y;
  };
  const GridPosition from = units_from(box.min_x, row(box.max_y));
  const GridPosition to = units_from(box.max_x, row(box.min_y));
  return {from.x, from.y, to.x, to.y};
}

WindowSides MapSystem::sides_of(const SystemBounds& bounds) const {
  const GridPosition south_west = cells_from(bounds.west, bounds.south);
  const GridPosition north_east = cells_from(bounds.east, bounds.north);
  return {south_west.x, north_east.y, north_east.x, south_west.y};
}

std::optional<View> MapSystem::view_of(const SystemBounds& bounds, int width, int height) const {
  return view_of_window(sides_of(bounds), width, height, projection);
}

const MapSystemPtr& web_mercator() {
  static const MapSystemPtr system =
      make({.name = "EPSG:3857",
            .other_names = {"EPSG:900913", "EPSG:102100", "EPSG:102113"},
            .uri = "http://www.opengis.net/def/crs/EPSG/0/3857",
            .urn = "urn:ogc:def:crs:EPSG::3857",
            .half_side = kMercatorHalfSide});
  return system;
}

const MapSystemPtr& crs84() {
  static const MapSystemPtr system =
      make({.name = "CRS:84",
            .other_names = {"OGC:CRS84", "CRS84", "urn:ogc:def:crs:OGC::CRS84"},
            .uri = "http://www.opengis.net/def/crs/OGC/1.3/CRS84",
            .urn = "urn:ogc:def:crs:OGC:1.3:CRS84",
            .projection = Projection::plate_carree,
            .is_in_degrees = true,
            .half_side = 180,
            .metres_per_unit = kMetresPerDegree});
  return system;
}

const MapSystemPtr& epsg4326() {
  static const MapSystemPtr system = make({.name = "EPSG:4326",
                                           .other_names = {},
                                           .uri = "http://www.opengis.net/def/crs/EPSG/0/4326",
                                           .urn = "urn:ogc:def:crs:EPSG::4326",
                                           .projection = Projection::plate_carree,
                                           .is_north_first = true,
                                           .is_in_degrees = true,
                                           .half_side = 180,
                                           .metres_per_unit = kMetresPerDegree});
  return system;
}

std::span<const MapSystemPtr> usual_map_systems() {
  static const std::array<MapSystemPtr, 3> systems = {web_mercator(), crs84(), epsg4326()};
  return systems;
}

MapSystemPtr map_system_of_grid(const std::string& grid) {
  const std::shared_ptr<const TargetGrid> target = find_target_grid(grid);
  static std::mutex mutex;
  static std::map<std::string, MapSystemPtr> known;
  const std::lock_guard lock(mutex);
  MapSystemPtr& system = known[grid];
  if (system != nullptr) return system;
  const std::size_t colon = grid.find(':');
  const std::string authority = grid.substr(0, colon);
  const std::string code = grid.substr(colon + 1);
  system = make({.name = grid,
                 .uri = fmt::format("http://www.opengis.net/def/crs/{}/0/{}", authority, code),
                 .urn = fmt::format("urn:ogc:def:crs:{}::{}", authority, code),
                 .projection = Projection::plane,
                 .is_north_first = target->is_north_first,
                 .half_side = target->half_side,
                 .middle_x = target->middle_x,
                 .middle_y = target->middle_y,
                 .metres_per_unit = target->metres_per_unit,
                 .grid = grid});
  return system;
}

std::vector<MapSystemPtr> map_systems_of(const Dataset& dataset, std::string_view layer) {
  std::vector<MapSystemPtr> systems;
  if (!dataset.find(layer)) return systems;
  systems.assign(usual_map_systems().begin(), usual_map_systems().end());
  for (const std::string& grid : dataset.grids()) {
    if (dataset.find(layer, grid)) systems.push_back(map_system_of_grid(grid));
  }
  return systems;
}

std::vector<MapSystemPtr> map_systems_of(const Dataset& dataset) {
  std::vector<MapSystemPtr> systems(usual_map_systems().begin(), usual_map_systems().end());
  for (const std::string& grid : dataset.grids()) systems.push_back(map_system_of_grid(grid));
  return systems;
}

MapSystemPtr find_map_system(std::string_view name, const Dataset& dataset) {
  for (const MapSystemPtr& system : map_systems_of(dataset)) {
    if (system->is_called(name)) return system;
  }
  return nullptr;
}

std::string names_of(std::span<const MapSystemPtr> systems) {
  std::string names;
  for (const MapSystemPtr& system : systems) {
    names += names.empty() ? system->name : ", " + system->name;
  }
  return names;
}

std::string uris_of(std::span<const MapSystemPtr> systems) {
  std::string uris;
  for (const MapSystemPtr& system : systems) {
    uris += uris.empty() ? system->uri : ", " + system->uri;
  }
  return uris;
}

const ServedLayer* served_in(const Dataset& dataset, std::string_view layer,
                             const MapSystem& system) {
  const auto position = dataset.find(layer, system.grid);
  return position ? &dataset.layers_on_all_grids()[*position] : nullptr;
}

Problem not_built(const std::string& layer, const MapSystem& system, const Dataset& dataset) {
  const std::string names = names_of(map_systems_of(dataset, layer));
  return {
      400,
      fmt::format("The layer \"{}\" is not built for {}, only for {}.", layer, system.name, names),
      "crs", system.name, names};
}

}  // namespace trapeze
