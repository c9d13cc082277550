// Vector files in common formats, written by GDAL for a test to read.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <ogrsf_frmts.h>

namespace trapeze {

struct TestFeature {
  std::string wkt = {};  // empty: no geometry
  int number = 0;
  std::string text = {};
};

struct TestLayer {
  std::string name = "layer";
  std::string crs = "EPSG:4326";  // empty: none
  OGRwkbGeometryType type = wkbUnknown;
  std::vector<TestFeature> features = {};
};

/// Writes a source with the fields `number` and `text`; throws if GDAL cannot.
void write_source(const std::string& path, const std::string& driver,
                  const std::vector<TestLayer>& layers);

/// A dataset that a test fills itself; throws if GDAL cannot create it.
GDALDatasetUniquePtr create_source(const std::string& path, const std::string& driver);

OGRSpatialReference test_reference(const std::string& crs);

std::unique_ptr<OGRGeometry> test_geometry(const std::string& wkt);

}  // namespace trapeze
