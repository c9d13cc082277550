#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <string>

#include "core/grid/tolerance.h"
#include "core/grid/web_mercator.h"
#include "core/io/export/export_layer.h"
#include "server/cli/commands.h"
#include "server/data/load_progress.h"

namespace trapeze {
namespace {

constexpr double kPixelsPerTile = 256;

double cells_per_pixel(int zoom) {
  return static_cast<double>(TileId{zoom, 0, 0}.side()) / kPixelsPerTile;
}

/// The tolerance of a tile at this zoom: a level of the ladder, as in the server.
double epsilon_of(int zoom, double pixels) {
  return epsilon_of_level(nearest_level(pixels * cells_per_pixel(zoom)));
}

ExportOptions options_from(const ExportArguments& arguments) {
  ExportOptions options;
  options.epsilon = epsilon_of(arguments.zoom, arguments.simplify);
  if (arguments.smooth > 0 && arguments.grow > 0) {
    throw UsageError("--grow and --smooth exclude each other");
  }
  options.smooth = {arguments.smooth, cells_per_pixel(arguments.zoom)};
  options.grow = {arguments.grow, cells_per_pixel(arguments.zoom)};
  options.generalization.topology = word_or_throw("--topology", arguments.topology, kTopologyNames);
  options.generalization.weights = word_or_throw("--weights", arguments.weights, kWeightNames);
  apply(arguments.coverage, options.generalization);
  options.crs = word_or_throw("--crs", arguments.crs, kExportCrsNames);
  options.overwrite = arguments.overwrite;
  return options;
}

void print_if_any(const char* what, std::size_t count) {
  if (count > 0) fmt::print("  {}: {}\n", what, count);
}

void print_report(const ExportReport& report, const std::string& output, bool is_merging) {
  fmt::print(
      "{} ({}): {} features with {} polygons; {} of {} vertices kept, {} of these held by the "
      "topology test; {} features left out as too small{}\n",
      output, report.driver, report.written, report.polygons, report.vertices, report.all_vertices,
      report.held, report.too_small, is_merging ? " or as parts of the blocks of others" : "");
  print_if_any("corners rounded", report.corners.rounded);
  print_if_any("corners left sharp here, though tiles round them, to keep edges apart on the grid",
               report.corners.refused);
  print_if_any("features with narrow places that were widened", report.grown);
  print_if_any("features that are not polygons", report.other_geometry);
  print_if_any("features smaller than the grid, or outside the world", report.empty);
  print_if_any("features skipped", report.skipped);
  print_if_any("features that crossed themselves and were noded", report.crossed);
  print_if_any("polygons that got vertices on long edges to be valid in degrees",
               report.subdivided);
  print_if_any("polygons with too many holes to be checked in degrees", report.unchecked);
  print_if_any("features that are not valid in degrees, but are in EPSG:3857", report.invalid);
  for (const std::string& warning : report.warnings)
    fmt::print("  warning: the source {}\n", warning);
  for (const FeatureNote& note : report.notes) {
    fmt::print("  feature {}: {}\n", note.id, note.reason);
  }
}

}  // namespace

int run_export(const ExportArguments& arguments) {
  check_polygon_ending("--output", arguments.output);
  ExportOptions options = options_from(arguments);
  ExportReport report;
  {
    LoadProgress progress(arguments.file);
    options.progress = [&progress](double share) { progress.show(share); };
    report = export_layer(arguments.file, arguments.output, options);
  }
  print_report(report, arguments.output, options.generalization.merge > 0);
  return 0;
}

}  // namespace trapeze
