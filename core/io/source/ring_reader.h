// Converts the geometry of a feature, as GDAL returns it, to rings on the grid.
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

/// The rings of one feature on the grid, with figures about their source.
struct FeatureRings {
  Rings rings;  // clipped to the world; may be empty
  // The parts of a multipolygon: part i is rings part_ends[i - 1] .. part_ends[i] - 1. Empty for
  // formats that store plain rings without specifying which belong together.
  std::vector<std::uint32_t> part_ends;
  std::size_t polygons = 0;      // in the source
  std::size_t source_rings = 0;  // in the source
  std::size_t vertices = 0;      // in the source, including closing ones
  std::string failure;           // why the feature cannot be drawn; empty if it can
  bool has_wrong_units = false;  // no CRS is given, and a coordinate cannot be degrees

  void clear();
};

/// Whether a geometry of this type can be, or contain, a polygon.
bool can_hold_polygons(OGRwkbGeometryType type);
/// Whether it does: it is a polygon, a surface of polygons, or a collection that contains one.
bool has_polygons(const OGRGeometry& geometry);

/// Converts geometries of one CRS to rings. Curves are linearized and collections split; points,
/// lines and the third dimension are ignored. Positions are projected, clipped to the Web Mercator
/// square, and snapped to the nearest cell, without consecutive duplicates. Geometry beyond the
/// 180th meridian reappears on the other side, and edges of a kilometre or more that run within two
/// metres of it are moved onto it. A polygon that is longer than the world becomes a part for each
/// turn, because it covers places twice. Rings are neither sorted nor validated.
///
/// On the grid of another system, rings are clipped to the extent that it shows. Edges, which are
/// straight in the source, are cut so finely that they stay in place: see GridRings.
///
/// Use only on the thread that created it.
class RingReader {
 public:
  struct Options {
    bool shells_are_clockwise = false;  // count clockwise rings as polygons instead of OGR's
                                        // polygons
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
  void note_extent(std::size_t begin, std::size_t end);
  bool is_longer_than_world() const;
  void append_on_grid(FeatureRings& feature);
  void append_parts_on_grid(const PositionRing& ring, double turn, FeatureRings& feature);
  void append_ring(std::size_t begin, std::size_t end, FeatureRings& feature);
  void separate_turns(std::size_t first, FeatureRings& feature) const;
  void unwrap_ring(std::size_t begin, std::size_t end);
  void project_ring();
  void clip_latitude();
  void append_clipped(double shift, Rings& rings);

  const SourceCrs& crs_;
  Options options_;
  std::unique_ptr<LonLatTransform> transform_;  // for the kinds that need one
  std::unique_ptr<GridRings> grid_;             // null: Web Mercator

  // Of the current feature, ring after ring: first in coordinates of the source, then in degrees or
  // metres.
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<std::size_t> ends_;
  std::vector<std::size_t> part_ends_;  // in rings, cumulative
  // Coordinates before the transformation, if there was one.
  std::vector<double> source_x_;
  std::vector<double> source_y_;
  // The current ring: in degrees, then in cells.
  PositionRing ring_;
  PositionRing on_plane_;  // the ring on the plane of the source
  PositionRing clipped_;
  PositionRing scratch_;
  std::vector<PositionRing> parts_;  // parts of the ring on the grid of another system
  // Of each ring of the feature: by how many turns around the world it was moved, in cells of Web
  // Mercator.
  std::vector<double> turns_;
  double west_ = 0;  // of the current part: in cells, or on the grid of another system in degrees
  double east_ = 0;
};

}  // namespace trapeze
