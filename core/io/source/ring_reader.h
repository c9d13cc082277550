// From the geometry of a feature, as GDAL gives it, to rings on the grid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <ogr_geometry.h>

#include "core/grid/rings.h"
#include "core/io/source/clip_ring.h"
#include "core/io/source/grid_rings.h"
#include "core/io/source/source_crs.h"

namespace trapeze {

/// The rings of one feature on the grid, and what they came from.
struct FeatureRings {
  Rings rings;  // clipped to the world; may be empty
  // The parts of a multipolygon: part i is rings part_ends[i - 1] .. part_ends[i] - 1. Formats that
  // store rings alone do not say which belong together: none.
  std::vector<std::uint32_t> part_ends;
  std::size_t polygons = 0;      // in the source
  std::size_t source_rings = 0;  // in the source
  std::size_t vertices = 0;      // in the source, closing ones included
  std::string failure;           // why the feature cannot be drawn; empty if it can
  bool has_wrong_units = false;  // no CRS is given and a coordinate is no degree

  void clear();
};

/// Whether a geometry of this type can hold polygons, itself or its parts.
bool can_hold_polygons(OGRwkbGeometryType type);
/// Whether it does: it is a polygon or a surface of polygons, or a collection with one in it.
bool has_polygons(const OGRGeometry& geometry);

/// Turns geometries of one CRS into rings: curves are linearised, collections taken apart, points
/// and lines and the third dimension ignored; positions are projected, clipped to the Web Mercator
/// square, and snapped to the nearest cell, without consecutive duplicates. What lies beyond the
/// 180th meridian comes back in on the other side, and edges of a kilometre and more that run
/// within two metres of it are on it. Rings are neither sorted nor validated.
///
/// On the grid of another system, rings are clipped to what that shows, and edges, which are
/// straight in the source, are cut so finely that they stay where they are: see GridRings.
///
/// Belongs to the thread that made it.
class RingReader {
 public:
  struct Options {
    bool shells_are_clockwise = false;  // count clockwise rings as polygons, not OGR's polygons
    std::shared_ptr<const TargetGrid> grid = {};  // null: Web Mercator
  };

  /// `crs` must outlive the reader. Throws SourceError if it cannot be projected.
  RingReader(const SourceCrs& crs, Options options);

  /// Replaces `feature` by the rings of `geometry`.
  void read(const OGRGeometry& geometry, FeatureRings& feature);

 private:
  void collect(const OGRGeometry& geometry, FeatureRings& feature);
  void collect_polygon(const OGRPolygon& polygon, FeatureRings& feature);
  void collect_ring(const OGRLinearRing& ring, FeatureRings& feature);
  void check_coordinates(FeatureRings& feature) const;
  void check_degrees(FeatureRings& feature) const;
  void to_lonlat(FeatureRings& feature);
  void cut_source_edges(FeatureRings& feature);
  bool map_to_lonlat(std::vector<double>& x, std::vector<double>& y);
  void append_on_grid(FeatureRings& feature);
  void append_ring(std::size_t begin, std::size_t end, FeatureRings& feature);
  void unwrap_ring(std::size_t begin, std::size_t end);
  void project_ring();
  void clip_latitude();
  void append_clipped(double shift, Rings& rings);

  const SourceCrs& crs_;
  Options options_;
  std::unique_ptr<LonLatTransform> transform_;  // for the kinds that need one
  std::unique_ptr<GridRings> grid_;             // null: Web Mercator

  // Of the current feature, ring after ring: coordinates of the source, then degrees or metres.
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<std::size_t> ends_;
  std::vector<std::size_t> part_ends_;  // rings, in the same way
  // Before they were transformed, if they were.
  std::vector<double> source_x_;
  std::vector<double> source_y_;
  // Of the current ring: degrees, then cells.
  PositionRing ring_;
  PositionRing on_plane_;  // of the source
  PositionRing clipped_;
  PositionRing scratch_;
  std::vector<PositionRing> parts_;  // of it on the grid of another system
};

}  // namespace trapeze
