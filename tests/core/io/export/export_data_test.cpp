// Real polygons written to files, and checked as another program would read them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <ostream>
#include <string>

#include <ogrsf_frmts.h>

#include "core/io/export/export_layer.h"
#include "tests/core/io/data/source_rings.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

struct ExportTrial {
  const char* file;
  int zoom;
  bool is_subdivided = false;  // is not valid in degrees without further vertices on long edges
};

void PrintTo(const ExportTrial& trial, std::ostream* out) {
  *out << trial.file << " at " << trial.zoom;
}

constexpr ExportTrial kTrials[] = {{"malta_landuse.fgb", 12},
                                   {"shenzhen_buildings.fgb", 13},
                                   {"us_counties.fgb", 4},
                                   {"lands_complex.fgb", 0, true},
                                   {"awkward/earcut.geojson", 9, true},
                                   {"awkward/geos_validity.geojson", 22, true}};

class ExportDataTest : public ::testing::TestWithParam<ExportTrial> {};

TEST_P(ExportDataTest, EveryPolygonOfEveryFormatIsValidInDegreesAndInMetres) {
  const char* data = std::getenv("TRAPEZE_DATA");
  if (data == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
  const std::filesystem::path path = std::filesystem::path(data) / GetParam().file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const TemporaryFolder folder;
  ExportOptions options;
  options.epsilon = testing::epsilon_of_zoom(GetParam().zoom);
  options.overwrite = true;
  for (const char* name : {"out.fgb", "out.gpkg", "out.geojson"}) {
    for (const ExportCrs crs : {ExportCrs::degrees, ExportCrs::web_mercator}) {
      options.crs = crs;
      const ExportReport report = export_layer(path.string(), folder.file(name), options);
      EXPECT_EQ(report.subdivided > 0, GetParam().is_subdivided && crs == ExportCrs::degrees);
      EXPECT_EQ(report.invalid, 0u);
      EXPECT_EQ(report.unchecked, 0u);
      const GDALDatasetUniquePtr written(
          GDALDataset::Open(folder.file(name).c_str(), GDAL_OF_VECTOR));
      ASSERT_NE(written, nullptr);
      std::size_t features = 0;
      for (const auto& feature : *written->GetLayer(0)) {
        ++features;
        EXPECT_TRUE(feature->GetGeometryRef()->IsValid())
            << name << ", feature " << feature->GetFieldAsInteger64("trapeze_id");
      }
      EXPECT_EQ(features, report.written);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Files, ExportDataTest, ::testing::ValuesIn(kTrials), [](const auto& test) {
  return std::filesystem::path(test.param.file).stem().string();
});

}  // namespace
}  // namespace trapeze
