// The reference systems that maps are drawn in.
//
// Thread-safety: any thread; systems are immutable.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/web_mercator.h"
#include "render/mask/mask.h"
#include "server/base/problem.h"
#include "server/data/dataset.h"
#include "server/tiles/map_window.h"

namespace trapeze {

/// Sides of a box in the units of a reference system. What is called west and east is the axis from
/// left to right on a map, whichever of the two the authority has first.
struct SystemBounds {
  double west = 0;
  double south = 0;
  double east = 0;
  double north = 0;
};

struct MapSystem {
  std::string name = {};                      // as clients write it: "EPSG:3857"
  std::vector<std::string> other_names = {};  // that are understood as well
  std::string uri = {};                       // of the OGC
  std::string urn = {};                       // of the OGC, as WMTS has it
  Projection projection = Projection::mercator;
  bool is_north_first = false;  // whether the authority has the axis from south to north first
  bool is_in_degrees = false;   // or else in units of a plane
  // The square that the cells are in, in units: half of its side, and its middle.
  double half_side = 0;
  double middle_x = 0;
  double middle_y = 0;
  double metres_per_unit = 1;  // on the ground of the equator, where units are degrees
  std::string grid = {};       // on which layers are built for it; empty: that of Web Mercator

  /// Whether it is known by that name, in any case of letters.
  bool is_called(std::string_view text) const;
  /// Cells of the picture, not rounded, from units and the other way round.
  GridPosition cells_from(double x, double y) const;
  GridPosition units_from(double x, double y) const;
  double metres_per_cell() const { return metres_per_unit * half_side / kGridMax; }
  /// The zoom of Web Mercator at which tiles of that scale have pixels as large, see zoom_of().
  double zoom_of(const View& view, double scale) const;
  /// Cells of a pixel of a tile of that zoom.
  double cells_at(double zoom) const;
  /// What a window of the picture, or a box of the grid, has for sides.
  SystemBounds bounds_of(const View& view) const;
  SystemBounds bounds_of(const Box& box) const;
  WindowSides sides_of(const SystemBounds& bounds) const;
  /// The picture of the window, see view_of_window().
  std::optional<View> view_of(const SystemBounds& bounds, int width, int height) const;
};

using MapSystemPtr = std::shared_ptr<const MapSystem>;

/// Those for which no layer has to be built, as all of them are for Web Mercator, which is first.
std::span<const MapSystemPtr> usual_map_systems();
const MapSystemPtr& web_mercator();  // EPSG:3857
const MapSystemPtr& crs84();         // longitude and latitude, in that order
const MapSystemPtr& epsg4326();      // latitude and longitude

/// That of a grid that layers can be built on, see find_target_grid(); throws as that does.
MapSystemPtr map_system_of_grid(const std::string& grid);

/// All that a layer is drawn in; empty if there is no such layer.
std::vector<MapSystemPtr> map_systems_of(const Dataset& dataset, std::string_view layer);
/// All that some layer is drawn in.
std::vector<MapSystemPtr> map_systems_of(const Dataset& dataset);
/// The same, by any of its names, its URI or its URN, or "[EPSG:3857]"; null if there is none.
MapSystemPtr find_map_system(std::string_view name, const Dataset& dataset);
/// "EPSG:3857, CRS:84, EPSG:4326", and others that some layer is drawn in.
std::string names_of(std::span<const MapSystemPtr> systems);
/// Their URIs, in the same way.
std::string uris_of(std::span<const MapSystemPtr> systems);

/// The layer as it is drawn in that system; null if there is none, or it is not built for it.
const ServedLayer* served_in(const Dataset& dataset, std::string_view layer,
                             const MapSystem& system);
/// The problem to answer with, 400, for a layer that is not built for a system.
Problem not_built(const std::string& layer, const MapSystem& system, const Dataset& dataset);

}  // namespace trapeze
