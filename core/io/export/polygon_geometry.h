// Converts polygons on the grid to geometries for other programs.
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

/// A geometry, with the measures taken to keep it valid.
struct PolygonGeometry {
  std::unique_ptr<OGRGeometry> geometry;  // a polygon, or a multipolygon of several
  std::size_t subdivided = 0;             // polygons that received additional vertices
  std::size_t unchecked = 0;  // polygons too large to be checked, or GDAL was built without GEOS
  bool is_invalid = false;    // additional vertices did not help
};

/// Converts the polygons to metres or degrees. `polygons` is not empty.
///
/// In metres they are exactly as drawn, scaled. Edges are straight on the Web Mercator map; in
/// degrees a long edge would take another course, possibly through the polygon's own boundary.
/// Polygons that are not valid in degrees therefore receive vertices along their long edges until
/// they are.
///
/// Thread-safety: may be called from any thread.
PolygonGeometry geometry_of(const Polygons& polygons, ExportCrs crs);

/// The same for polygons that share borders. Each may be empty and then has no geometry. If one of
/// them receives vertices along its edges, all of them do, so their borders stay identical.
std::vector<PolygonGeometry> geometries_of_neighbours(std::span<const Polygons> neighbours,
                                                      ExportCrs crs);

/// With x (east, longitude) first. Throws std::runtime_error if PROJ's database is missing.
OGRSpatialReference reference_of(ExportCrs crs);

}  // namespace trapeze
