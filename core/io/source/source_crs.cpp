#include "core/io/source/source_crs.h"

#include <cstdio>
#include <limits>
#include <numbers>
#include <string_view>

#include "core/io/source/gdal_messages.h"
#include "core/io/source/open_source.h"

namespace trapeze {
namespace {

bool has_longitude_first(const OGRSpatialReference& reference) {
  // Where the axis of the reference lies in the data; the mapping counts axes from 1.
  OGRAxisOrientation first_axis = OAO_Other;
  reference.GetAxis(nullptr, 0, &first_axis);
  const std::vector<int>& mapping = reference.GetDataAxisToSRSAxisMapping();
  if (mapping.size() < 2) return false;
  const bool latitude_is_first_axis = first_axis == OAO_North || first_axis == OAO_South;
  return mapping[0] == (latitude_is_first_axis ? 2 : 1) &&
         mapping[1] == (latitude_is_first_axis ? 1 : 2);
}

bool is_named(const OGRSpatialReference& reference, std::string_view authority,
              std::string_view code) {
  const char* name = reference.GetAuthorityName(nullptr);
  const char* number = reference.GetAuthorityCode(nullptr);
  return name != nullptr && number != nullptr && name == authority && number == code;
}

// Compares with the official definition, because files often lack the EPSG code.
bool equals_epsg(const OGRSpatialReference& reference, int code) {
  OGRSpatialReference other;
  if (other.importFromEPSG(code) != OGRERR_NONE) return false;
  const char* const options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES",
                                 "CRITERION=EQUIVALENT_EXCEPT_AXIS_ORDER_GEOGCRS", nullptr};
  return reference.IsSame(&other, options) != 0;
}

bool is_wgs84(const OGRSpatialReference& reference) {
  return is_named(reference, "EPSG", "4326") || is_named(reference, "OGC", "CRS84") ||
         equals_epsg(reference, 4326);
}

bool is_web_mercator(const OGRSpatialReference& reference) {
  if (reference.GetDataAxisToSRSAxisMapping() != std::vector<int>{1, 2} &&
      reference.GetDataAxisToSRSAxisMapping() != std::vector<int>{1, 2, 3}) {
    return false;
  }
  return is_named(reference, "EPSG", "3857") || equals_epsg(reference, 3857);
}

SourceCrs::Kind kind_of(const OGRSpatialReference& reference) {
  if (reference.IsGeographic()) {
    return has_longitude_first(reference) && is_wgs84(reference) ? SourceCrs::Kind::degrees
                                                                 : SourceCrs::Kind::geographic;
  }
  return is_web_mercator(reference) ? SourceCrs::Kind::web_mercator : SourceCrs::Kind::projected;
}

/// What a GeoPackage has, and what GDAL makes of it, for coordinates in degrees of an unknown CRS.
bool is_undefined(const OGRSpatialReference& reference) {
  const char* name = reference.GetName();
  return name != nullptr && reference.IsGeographic() &&
         std::string_view(name) == "Undefined geographic SRS";
}

std::string failing_point(double x, double y) {
  char text[80];
  std::snprintf(text, sizeof text, "the point %.10g %.10g cannot be reprojected", x, y);
  return text;
}

}  // namespace

SourceCrs SourceCrs::describe(const OGRSpatialReference* reference) {
  SourceCrs crs;
  if (reference == nullptr || reference->IsEmpty() || is_undefined(*reference)) return crs;
  crs.kind = kind_of(*reference);
  crs.reference.reset(reference->Clone());
  if (crs.kind == Kind::projected) crs.metres_per_unit = reference->GetLinearUnits();
  if (reference->IsGeographic() && has_longitude_first(*reference)) {
    crs.degrees_per_unit = reference->GetAngularUnits() * 180 / std::numbers::pi;
  }
  return crs;
}

std::string crs_advice(const std::string& driver) {
  if (driver == "ESRI Shapefile") return "put a .prj file beside it that names one";
  return "make a copy that names one, by `ogr2ogr -a_srs EPSG:NUMBER`";
}

std::string no_degrees_words(const std::string& driver) {
  return "names no coordinate reference system, and its coordinates are not degrees: " +
         crs_advice(driver);
}

LonLatTransform::LonLatTransform(const SourceCrs& crs) {
  OGRSpatialReference wgs84;
  wgs84.SetWellKnownGeogCS("WGS84");
  wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  GdalMessages messages;
  transformation_.reset(OGRCreateCoordinateTransformation(crs.reference.get(), &wgs84));
  if (transformation_ == nullptr) {
    const char* name = crs.reference->GetName();
    throw SourceError("its coordinate reference system" +
                      (name == nullptr ? "" : " \"" + std::string(name) + "\"") +
                      " cannot be transformed to WGS 84" +
                      (messages.text().empty() ? "" : ": " + messages.text()));
  }
}

std::string LonLatTransform::apply(std::vector<double>& x, std::vector<double>& y) {
  if (x.empty()) return {};
  if (x.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    return "has too many vertices to be reprojected";
  }
  const GdalMessages messages;
  const double first_x = x.front();
  const double first_y = y.front();
  succeeded_.assign(x.size(), 0);
  transformation_->Transform(static_cast<int>(x.size()), x.data(), y.data(), nullptr,
                             succeeded_.data());
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!succeeded_[i]) {
      return (i == 0 ? failing_point(first_x, first_y)
                     : "vertex " + std::to_string(i) + " cannot be reprojected") +
             (messages.text().empty() ? "" : ": " + messages.text());
    }
  }
  return {};
}

}  // namespace trapeze
