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
    assumed_degrees,  // no CRS is given: the same, if the coordinates allow it
    web_mercator,     // metres of EPSG:3857
    geographic,       // any other longitude and latitude
    projected         // everything else
  };

  Kind kind = Kind::assumed_degrees;
  // For a geographic CRS with longitude first: degrees per unit; 0 if latitude is first.
  double degrees_per_unit = 0;
  double metres_per_unit = 0;                            // of a projected CRS
  std::unique_ptr<const OGRSpatialReference> reference;  // null if there is none

  /// `reference` may be null, or the one with which a GeoPackage declares that it is unknown. The
  /// axis order is that of its data axis mapping.
  static SourceCrs describe(const OGRSpatialReference* reference);
};

/// How far beyond the world coordinates may lie that are taken for degrees without a CRS: rounding
/// and buffers carry valid data slightly beyond, pixels and metres go further.
inline constexpr double kDegreeSlack = 1;

/// Advice, in words, on how to assign a CRS to a source of this driver.
std::string crs_advice(const std::string& driver);
/// A message that a source of this driver has no CRS and has coordinates that are not degrees.
std::string no_degrees_words(const std::string& driver);

/// Transforms points of one CRS to degrees on WGS 84. Use only on the thread that created it.
class LonLatTransform {
 public:
  /// For the kinds `geographic` and `projected`. Throws SourceError with PROJ's reason if this CRS
  /// cannot be transformed to WGS 84.
  explicit LonLatTransform(const SourceCrs& crs);

  /// Replaces coordinates by longitude and latitude; longitudes may be wrapped into [-180, 180].
  /// Returns an empty string, or the reason why a point could not be transformed.
  std::string apply(std::vector<double>& x, std::vector<double>& y);

 private:
  std::unique_ptr<OGRCoordinateTransformation> transformation_;
  std::vector<int> succeeded_;
};

}  // namespace trapeze
