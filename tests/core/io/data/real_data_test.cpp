#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <string>

#include "core/io/load/load_layer.h"

namespace trapeze {
namespace {

struct Expected {
  const char* file;
  std::size_t features;
  std::size_t polygons;
  std::size_t vertices;
  std::size_t holes;
};

void PrintTo(const Expected& expected, std::ostream* out) {
  *out << expected.file;
}

// The figures of the data's own description, which were counted by other means.
constexpr Expected kFiles[] = {
    {"shenzhen_buildings.fgb", 59'419, 59'419, 574'196, 0},
    {"shenzhen_water.fgb", 143, 143, 2'257, 78},
    {"malta_buildings.fgb", 13'272, 13'283, 100'492, 121},
    {"malta_natural.fgb", 1'507, 1'509, 19'395, 22},
    {"malta_landuse.fgb", 3'387, 3'387, 66'746, 34},
    {"melbourne_natural.fgb", 8'539, 8'539, 177'862, 0},
    {"melbourne_landuse.fgb", 10'285, 10'285, 175'948, 0},
    {"lands_complex.fgb", 11, 1'107, 649'322, 68'585},
    {"usa48_land.fgb", 1, 178, 488'828, 89'852},
    {"kobroor.fgb", 1, 1, 65'252, 317},
    {"europe_countries.fgb", 14, 627, 357'205, 40'774},
    {"us_counties.fgb", 3'230, 3'495, 68'225, 14},
    {"awkward/earcut.geojson", 59, 59, 44'979, 2'809},
    {"awkward/poly2tri.geojson", 22, 22, 13'687, 3},
    {"awkward/geos_validity.geojson", 74, 95, 1'010, 73},  // and a hole without vertices
};

class RealDataTest : public ::testing::TestWithParam<Expected> {};

TEST_P(RealDataTest, EveryFeatureIsLoadedOrAccountedFor) {
  const char* folder = std::getenv("TRAPEZE_DATA");
  if (folder == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
  const std::filesystem::path path = std::filesystem::path(folder) / GetParam().file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const LoadedLayer loaded = load_layer(path.string());
  const LoadReport& report = loaded.report;
  EXPECT_EQ(report.features, GetParam().features);
  EXPECT_EQ(report.polygons, GetParam().polygons);
  EXPECT_EQ(report.source_vertices, GetParam().vertices);
  EXPECT_EQ(report.rings, GetParam().polygons + GetParam().holes);
  EXPECT_EQ(report.loaded + report.empty, report.features);
  EXPECT_EQ(report.skipped, 0u);
  EXPECT_EQ(loaded.layer->features().size(), report.features);
  // Polygons that collapse on a grid of two centimetres have a negligible area. Some of the
  // deliberately degenerate fixtures have none to begin with.
  EXPECT_LE(report.empty, 5u);
}

INSTANTIATE_TEST_SUITE_P(Files, RealDataTest, ::testing::ValuesIn(kFiles), [](const auto& test) {
  const std::string stem = std::filesystem::path(test.param.file).stem().string();
  return stem;
});

}  // namespace
}  // namespace trapeze
