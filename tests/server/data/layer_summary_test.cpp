#include "server/data/layer_summary.h"

#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <string>
#include <utility>
#include <vector>

#include "server/config/load_config.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

class StripAroundLayersTest : public ::testing::Test {
 protected:
  /// The strip around a layer of boxes between these longitudes, 10 degrees high.
  LongitudeStrip strip_around(const std::vector<std::pair<double, double>>& boxes) {
    std::string features;
    for (const auto& [west, east] : boxes) {
      features += fmt::format(
          R"({0}{{"type":"Feature","properties":{{}},"geometry":{{"type":"Polygon","coordinates":)"
          R"([[[{1},0],[{2},0],[{2},10],[{1},10],[{1},0]]]}}}})",
          features.empty() ? "" : ",", west, east);
    }
    folder_.write("boxes.geojson",
                  fmt::format(R"({{"type":"FeatureCollection","features":[{}]}})", features));
    const auto dataset = Dataset::load(layers_of_files({folder_.file("boxes.geojson")}));
    return strip_around_layers(std::vector<std::string>{"boxes"}, *dataset);
  }

  TemporaryFolder folder_;
};

void expect_strip(const LongitudeStrip& strip, double west, double east) {
  EXPECT_NEAR(strip.west, west, 0.1);
  EXPECT_NEAR(strip.east, east, 0.1);
}

TEST_F(StripAroundLayersTest, IsThatOfTheBounds) {
  expect_strip(strip_around({{10, 20}}), 10, 20);
  expect_strip(strip_around({{-100, -90}, {-20, 20}, {80, 90}}), -100, 90);
}

TEST_F(StripAroundLayersTest, GoesOverTheAntimeridianIfItIsNarrowerSo) {
  expect_strip(strip_around({{166, 179}, {-178, -176}}), 166, 184);
  expect_strip(strip_around({{30, 180}, {-180, -170}}), 30, 190);
  expect_strip(strip_around({{170, 171}, {-179, -60}}), 170, 300);
}

TEST_F(StripAroundLayersTest, IsTheWorldWhereThereIsNoGap) {
  expect_strip(strip_around({{-180, 10}, {10, 180}}), -180, 180);
}

}  // namespace
}  // namespace trapeze
