// From the coordinate reference system of a source to longitude and latitude.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <ogr_spatialref.h>

namespace trapeze {

/// The meaning of the coordinates of a layer. Immutable; any number of threads may read.
struct SourceCrs {
  enum class Kind {
    degrees,          // longitude, latitude on WGS 84
    assumed_degrees,  // no CRS is given: the same, if the numbers allow it
    web_mercator,     // metres of EPSG:3857
    geographic,       // any other longitude and latitude
    projected         // everything else
  };

  Kind kind = Kind::assumed_degrees;
  // Of a geographic CRS with longitude first: degrees in one of its units; 0 if latitude is first.
  double degrees_per_unit = 0;
  std::unique_ptr<const OGRSpatialReference> reference;  // null if there is none

  /// `reference` may be null; axis order is as its data axis mapping says.
  static SourceCrs describe(const OGRSpatialReference* reference);
};

/// Transforms points of one CRS to degrees on WGS 84. Belongs to the thread that made it.
class LonLatTransform {
 public:
  /// For the kinds `geographic` and `projected`. Throws SourceError with PROJ's reason if there is
  /// no way from this CRS to WGS 84.
  explicit LonLatTransform(const SourceCrs& crs);

  /// Replaces coordinates by longitude and latitude; longitudes may come out wrapped into
  /// [-180, 180]. Returns an empty string, or why a point could not be transformed.
  std::string apply(std::vector<double>& x, std::vector<double>& y);

 private:
  std::unique_ptr<OGRCoordinateTransformation> transformation_;
  std::vector<int> succeeded_;
};

}  // namespace trapeze
