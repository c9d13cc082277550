#include "tests/core/io/source/written_source.h"

#include <stdexcept>

namespace trapeze {
namespace {

void check(bool is_done, const std::string& what) {
  if (!is_done) throw std::runtime_error("test source: " + what + ": " + CPLGetLastErrorMsg());
}

void write_feature(OGRLayer& layer, const TestFeature& feature) {
  const OGRFeatureUniquePtr row(OGRFeature::CreateFeature(layer.GetLayerDefn()));
  row->SetField("number", feature.number);
  row->SetField("text", feature.text.c_str());
  if (!feature.wkt.empty()) row->SetGeometry(test_geometry(feature.wkt).get());
  check(layer.CreateFeature(row.get()) == OGRERR_NONE, feature.wkt);
}

void write_layer(GDALDataset& dataset, const TestLayer& layer) {
  OGRSpatialReference reference;
  if (!layer.crs.empty()) reference = test_reference(layer.crs);
  OGRLayer* out = dataset.CreateLayer(layer.name.c_str(), layer.crs.empty() ? nullptr : &reference,
                                      layer.type, nullptr);
  check(out != nullptr, layer.name);
  OGRFieldDefn number("number", OFTInteger);
  OGRFieldDefn text("text", OFTString);
  out->CreateField(&number);
  out->CreateField(&text);
  for (const TestFeature& feature : layer.features) write_feature(*out, feature);
}

}  // namespace

void write_source(const std::string& path, const std::string& driver,
                  const std::vector<TestLayer>& layers) {
  const GDALDatasetUniquePtr dataset = create_source(path, driver);
  for (const TestLayer& layer : layers) write_layer(*dataset, layer);
}

GDALDatasetUniquePtr create_source(const std::string& path, const std::string& driver) {
  GDALAllRegister();
  GDALDriver* format = GetGDALDriverManager()->GetDriverByName(driver.c_str());
  check(format != nullptr, driver);
  GDALDatasetUniquePtr dataset(format->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  check(dataset != nullptr, path);
  return dataset;
}

OGRSpatialReference test_reference(const std::string& crs) {
  OGRSpatialReference reference;
  check(reference.SetFromUserInput(crs.c_str()) == OGRERR_NONE, crs);
  reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return reference;
}

std::unique_ptr<OGRGeometry> test_geometry(const std::string& wkt) {
  OGRGeometry* geometry = nullptr;
  check(OGRGeometryFactory::createFromWkt(wkt.c_str(), nullptr, &geometry) == OGRERR_NONE, wkt);
  return std::unique_ptr<OGRGeometry>(geometry);
}

}  // namespace trapeze
