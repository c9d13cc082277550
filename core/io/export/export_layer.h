// Writes the polygons of a source as they are drawn at a tolerance into a file of its own, on all
// cores.
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
  RoundingSize smooth;  // of corners; none is rounded if its radius is 0
  GrowthSize grow;      // of what is narrow; nothing grows if its width is 0. Not beside `smooth`
  LayerOptions generalization;
  ExportCrs crs = ExportCrs::degrees;
  bool overwrite = false;  // replace an output that exists
  unsigned threads = 0;    // 0: one a core
  /// As in LoadOptions.
  std::function<void(double)> progress;
};

/// What was written. Every feature is counted once in exactly one of `written`, `too_small`,
/// `other_geometry`, `empty`, `skipped`.
struct ExportReport {
  std::string driver;                 // that wrote
  std::vector<std::string> warnings;  // of the source, FeatureSource::warnings()
  std::size_t features = 0;           // in the source
  std::size_t written = 0;
  std::size_t too_small = 0;       // nothing of them is left at the tolerance
  std::size_t other_geometry = 0;  // points, lines, no geometry
  std::size_t empty = 0;           // smaller than the grid, or outside the world
  std::size_t skipped = 0;         // could not be read, reprojected or repaired
  std::size_t polygons = 0;        // written
  std::size_t rings = 0;           // written
  std::size_t vertices = 0;        // left at the tolerance
  std::size_t all_vertices = 0;    // of the same features and the too small ones, untouched
  std::size_t held = 0;  // vertices of less weight than the tolerance that the topology test kept
  RoundedCorners corners;
  std::size_t grown = 0;       // features of which anything grew
  std::size_t crossed = 0;     // features that crossed themselves, for want of the test; noded
  std::size_t subdivided = 0;  // polygons that got vertices on long edges to be valid in degrees
  std::size_t unchecked = 0;   // polygons with too many holes to check whether they are so
  std::size_t invalid = 0;     // features that could not be made so
  std::vector<FeatureNote> notes;  // for each skipped and each invalid feature, in their order
};

/// Reads `source` as load_layer() does, adapts every feature's graph to the tolerance, and writes
/// its polygons to `output`: FlatGeobuf (.fgb), GeoPackage (.gpkg) or GeoJSON (.geojson). In
/// formats whose layers have one type of geometry all are multipolygons; in GeoJSON, those of
/// several parts.
///
/// With a coverage among the options, neighbours are adapted together, and have every edge of their
/// common border in common; the whole source is held in memory.
///
/// With `smooth`, corners are rounded as tiles show them: neighbours in common, and none where
/// polygons lie over each other at full detail, or where another vertex is near, whose ever it is
/// (see round_corners()). With `grow`, what is narrow is as wide as tiles show it (see grow()).
/// With either, the whole source is held in memory.
///
/// Attributes keep their names and types; what the format cannot hold (lists, times of day) becomes
/// text as in AttributeReader, and names that would clash get a number. The field `trapeze_id`
/// holds the source's id of each feature; of a source with several layers, `trapeze_layer` tells
/// which. The order is the source's, except in FlatGeobuf, which sorts by place. The output does
/// not depend on the number of threads.
///
/// The output appears under its name only when it is complete. Throws std::runtime_error that names
/// the path: as load_layer() for the source; if what grows cannot be united; and for an output that
/// exists and is not to be overwritten, is the source itself, has another extension, or cannot be
/// written.
///
/// Thread-safety: may be called from several threads at once, for different outputs.
ExportReport export_layer(const std::string& source, const std::string& output,
                          const ExportOptions& options = {});

}  // namespace trapeze
