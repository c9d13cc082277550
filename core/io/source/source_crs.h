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
  double metres_per_unit = 0;                            // of a projected one
  std::unique_ptr<const OGRSpatialReference> reference;  // null if there is none

  /// `reference` may be null, or the one by which a GeoPackage says that it is not known; axis
  /// order is as its data axis mapping says.
  static SourceCrs describe(const OGRSpatialReference* reference);
};

/// How far beyond the world degrees may lie that no CRS says to be degrees: rounding and buffers
/// carry honest data a little beyond, pixels and metres go further.
inline constexpr double kDegreeSlack = 1;

/// In words, how a source of this driver is given a CRS.
std::string crs_advice(const std::string& driver);
/// In words, that a source of this driver has none, and coordinates that are not degrees.
std::string no_degrees_words(const std::string& driver);

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
