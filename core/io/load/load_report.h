// Findings about a source, collected while it was loaded.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace trapeze {

/// A feature that was repaired or left out, with a message for the user.
struct FeatureNote {
  std::int64_t id = 0;
  std::string reason;
};

/// Findings about polygons that share borders.
struct CoverageCounts {
  std::size_t groups = 0;        // of polygons that share one graph
  std::size_t features = 0;      // in them
  std::size_t noded = 0;         // groups in which borders crossed, or lacked vertices on one side
  std::size_t shared_edges = 0;  // between two features, each once
  std::size_t junctions = 0;     // vertices where three or more borders meet
  std::size_t overlaps = 0;      // pairs of features where one is drawn over a part of the other
  std::size_t gaps = 0;          // places between features that none of them covers
  std::size_t filled = 0;        // gaps narrow enough to become a part of a neighbour
  std::size_t snapped = 0;       // vertices moved or added to close gaps
  std::size_t apart = 0;  // features built separately because they overlap their neighbours too
                          // much
};

/// All of them.
inline constexpr std::array kCoverageCounts = {
    &CoverageCounts::groups,       &CoverageCounts::features,  &CoverageCounts::noded,
    &CoverageCounts::shared_edges, &CoverageCounts::junctions, &CoverageCounts::overlaps,
    &CoverageCounts::gaps,         &CoverageCounts::filled,    &CoverageCounts::snapped,
    &CoverageCounts::apart};

/// Findings about a source. Every feature is counted exactly once, in `loaded`, `other_geometry`,
/// `empty` or `skipped`.
struct LoadReport {
  std::string path;  // as used in messages, see name_of_source()
  std::string driver;
  std::vector<std::string> warnings;  // of the source, FeatureSource::warnings(); not stored in
                                      // prepared files
  std::string prepared_from;          // the source of a prepared layer; empty if the source itself
                                      // was read
  std::size_t features = 0;           // in the source
  std::size_t loaded = 0;             // drawn
  std::size_t other_geometry = 0;     // points, lines, no geometry: not drawn
  std::size_t empty = 0;              // polygons smaller than the grid or outside the world
  std::size_t skipped = 0;            // could not be read, reprojected or repaired
  // Parts of multipolygons. Formats that store plain rings do not specify which belong together:
  // for OpenStreetMap relations every ring counts, for Shapefiles and File Geodatabases every
  // clockwise one.
  std::size_t polygons = 0;
  std::size_t rings = 0;
  std::size_t source_vertices = 0;
  std::size_t vertices = 0;  // in the finished graphs
  std::size_t collapsed_rings = 0;
  std::size_t repaired = 0;  // noded: crossings, touches, overlaps
  /// Drawn features that were taken over from an earlier layer; not stored in prepared files.
  std::size_t taken_over = 0;
  CoverageCounts coverage;  // all 0 if coverages are off
  std::vector<FeatureNote>
      notes;                // one for each skipped feature, the first hundred of others (repaired)
  double read_seconds = 0;  // wall time until the last feature was read, or the file mapped
  double total_seconds = 0;

  /// The driver and, for a prepared layer, its source, in words.
  std::string origin() const {
    return prepared_from.empty() ? driver : driver + ", prepared from " + prepared_from;
  }
};

}  // namespace trapeze
