// From polygons on the grid to geometries as other programs read them.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <ogr_geometry.h>
#include <ogr_spatialref.h>

#include "core/borders/polygons.h"
#include "core/io/export/export_crs.h"

namespace trapeze {

/// A geometry, and what had to be done to keep it valid.
struct PolygonGeometry {
  std::unique_ptr<OGRGeometry> geometry;  // a polygon, or a multipolygon of several
  std::size_t subdivided = 0;             // polygons that got further vertices
  std::size_t unchecked = 0;  // polygons too large to be checked, or GDAL was built without GEOS
  bool is_invalid = false;    // further vertices did not help
};

/// The polygons in metres or degrees.
///
/// In metres they are what is drawn, scaled. Edges are straight on the Web Mercator map, and in
/// degrees a long one would run elsewhere, perhaps through the polygon's own boundary: polygons
/// that are not valid in degrees get vertices along their long edges until they are. `polygons` is
/// not empty.
///
/// Thread-safety: any thread.
PolygonGeometry geometry_of(const Polygons& polygons, ExportCrs crs);

/// The same of polygons that share borders, each of which may be empty and then has no geometry: if
/// one of them gets vertices along its edges, all of them do, and their borders stay in common.
std::vector<PolygonGeometry> geometries_of_neighbours(std::span<const Polygons> neighbours,
                                                      ExportCrs crs);

/// With x (east, longitude) first. Throws std::runtime_error if PROJ lacks its database.
OGRSpatialReference reference_of(ExportCrs crs);

}  // namespace trapeze
