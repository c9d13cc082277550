// Reference systems in which maps are drawn.
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

/// Sides of a box in units of a reference system. West and east are the ends of the axis that runs
/// from left to right on a map, whichever axis the authority lists first.
struct SystemBounds {
  double west = 0;
  double south = 0;
  double east = 0;
  double north = 0;
};

struct MapSystem {
  std::string name = {};                      // as clients write it: "EPSG:3857"
  std::vector<std::string> other_names = {};  // also accepted
  std::string uri = {};                       // assigned by the OGC
  std::string urn = {};                       // assigned by the OGC, as used in WMTS
  Projection projection = Projection::mercator;
  bool is_north_first = false;  // whether the authority lists the south-north axis first
  bool is_in_degrees = false;   // otherwise in units of a plane
  // The square that the cells cover, in units: half of its side, and its centre.
  double half_side = 0;
  double middle_x = 0;
  double middle_y = 0;
  double metres_per_unit = 1;  // on the equator, where units are degrees
  std::string grid = {};       // on which layers are built for it; empty: that of Web Mercator

  /// Whether this is one of its names, ignoring case.
  bool is_called(std::string_view text) const;
  /// Converts units to cells of the picture, not rounded, and back.
  GridPosition cells_from(double x, double y) const;
  GridPosition units_from(double x, double y) const;
  double metres_per_cell() const { return metres_per_unit * half_side / kGridMax; }
  /// The zoom of Web Mercator at which tiles of that scale have pixels of the same size, see
  /// zoom_of().
  double zoom_of(const View& view, double scale) const;
  /// Cells of one pixel of a tile of that zoom.
  double cells_at(double zoom) const;
  /// The bounds of a window of the picture, or of a box of the grid.
  SystemBounds bounds_of(const View& view) const;
  SystemBounds bounds_of(const Box& box) const;
  WindowSides sides_of(const SystemBounds& bounds) const;
  /// The picture of the window, see view_of_window().
  std::optional<View> view_of(const SystemBounds& bounds, int width, int height) const;
};

using MapSystemPtr = std::shared_ptr<const MapSystem>;

/// The systems that every layer built for Web Mercator can be drawn in. Web Mercator comes first.
std::span<const MapSystemPtr> usual_map_systems();
const MapSystemPtr& web_mercator();  // EPSG:3857
const MapSystemPtr& crs84();         // longitude and latitude, in that order
const MapSystemPtr& epsg4326();      // latitude and longitude

/// The system of a grid that layers can be built on, see find_target_grid(); throws the same
/// errors.
MapSystemPtr map_system_of_grid(const std::string& grid);

/// All systems that the layer can be drawn in; empty if there is no such layer.
std::vector<MapSystemPtr> map_systems_of(const Dataset& dataset, std::string_view layer);
/// All systems that any layer can be drawn in.
std::vector<MapSystemPtr> map_systems_of(const Dataset& dataset);
/// Finds a system by any of its names, its URI or its URN, or by "[EPSG:3857]"; null if there is
/// none.
MapSystemPtr find_map_system(std::string_view name, const Dataset& dataset);
/// "EPSG:3857, CRS:84, EPSG:4326", and others that some layer can be drawn in.
std::string names_of(std::span<const MapSystemPtr> systems);
/// Their URIs, in the same format.
std::string uris_of(std::span<const MapSystemPtr> systems);

/// The layer as drawn in that system; null if there is no such layer, or if it is not built for the
/// system.
const ServedLayer* served_in(const Dataset& dataset, std::string_view layer,
                             const MapSystem& system);
/// The problem to answer with, 400, if a layer is not built for a system.
Problem not_built(const std::string& layer, const MapSystem& system, const Dataset& dataset);

}  // namespace trapeze
