// Writes the polygons of a source, as drawn at a tolerance, into a new file, on all cores.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/borders/grown_polygons.h"
#include "core/borders/rounded_polygons.h"
#include "core/io/export/export_crs.h"
#include "core/io/load/load_report.h"
#include "core/layer/layer_options.h"

namespace trapeze {

struct ExportOptions {
  double epsilon = 0;   // the tolerance, in cells; 0: nothing is removed
  RoundingSize smooth;  // of corners; a radius of 0 rounds none
  GrowthSize grow;      // of narrow features; a width of 0 grows nothing. Not together with
                        // `smooth`
  LayerOptions generalization;
  ExportCrs crs = ExportCrs::degrees;
  bool overwrite = false;  // replace an existing output
  unsigned threads = 0;    // 0: one per core
  /// As in LoadOptions.
  std::function<void(double)> progress;
};

/// The result. Every feature is counted exactly once, in `written`, `too_small`, `other_geometry`,
/// `empty` or `skipped`.
struct ExportReport {
  std::string driver;                 // with which the file was written
  std::vector<std::string> warnings;  // of the source, FeatureSource::warnings()
  std::size_t features = 0;           // in the source
  std::size_t written = 0;
  std::size_t too_small = 0;       // nothing is left of them at the tolerance
  std::size_t other_geometry = 0;  // points, lines, no geometry
  std::size_t empty = 0;           // smaller than the grid, or outside the world
  std::size_t skipped = 0;         // could not be read, reprojected or repaired
  std::size_t polygons = 0;        // written
  std::size_t rings = 0;           // written
  std::size_t vertices = 0;        // left at the tolerance
  std::size_t all_vertices = 0;    // of the same features and those too small, before
                                   // simplification
  std::size_t held = 0;  // vertices of smaller weight than the tolerance, kept by the topological
                         // consistency test
  RoundedCorners corners;
  std::size_t grown = 0;       // features that grew anywhere
  std::size_t crossed = 0;     // features that crossed themselves because the test was off; noded
  std::size_t subdivided = 0;  // polygons given vertices on long edges to be valid in degrees
  std::size_t unchecked = 0;   // polygons with too many holes to check their validity
  std::size_t invalid = 0;     // features that could not be made valid
  std::vector<FeatureNote> notes;  // for each skipped and each invalid feature, in order
};

/// Reads `source` like load_layer(), adapts every feature's graph to the tolerance, and writes its
/// polygons to `output`: FlatGeobuf (.fgb), GeoPackage (.gpkg) or GeoJSON (.geojson). In formats
/// whose layers have one type of geometry, all features are multipolygons; in GeoJSON, only those
/// with several parts are.
///
/// With a coverage among the options, neighbours are adapted together and have identical edges
/// along their shared border; the whole source is held in memory.
///
/// With `smooth`, corners are rounded as tiles show them: identically for neighbours, but not where
/// polygons overlap at full detail, or where another vertex is near, whichever polygon it belongs
/// to (see round_corners()). With `grow`, narrow features are as wide as tiles show them (see
/// grow()). With either, the whole source is held in memory.
///
/// Attributes keep their names and types. Values that the format cannot hold (lists, times of day)
/// become text as in AttributeReader, and names that would clash get a number. Before 3.8, GDAL
/// writes text that is a JSON array or object as such into GeoJSON. The field
/// `trapeze_id` holds the source's id of each feature; for a source with several layers,
/// `trapeze_layer` holds its layer. The order is that of the source, except in FlatGeobuf, which
/// sorts by place. The output does not depend on the number of threads.
///
/// The output appears under its name only when it is complete. Throws std::runtime_error that names
/// the path: for the source, like load_layer(); if grown polygons cannot be united; and for an
/// output that exists and must not be overwritten, is the source itself, has another extension, or
/// cannot be written.
///
/// Thread-safety: may be called from several threads at the same time, for different outputs.
ExportReport export_layer(const std::string& source, const std::string& output,
                          const ExportOptions& options = {});

}  // namespace trapeze
