// Tiles of real layers that are known without drawing equal the tiles that are drawn.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "server/config/load_config.h"
#include "server/data/layer_summary.h"
#include "tests/server/seed/seeded_tiles.h"

namespace trapeze {
namespace {

/// The last zoom at which a box `degrees` wide is no wider than a tile.
int zoom_of_width(double degrees) {
  constexpr double kAround = 360;
  return std::clamp(static_cast<int>(std::floor(std::log2(kAround / degrees))), 0, kMaxZoom);
}

class RealSeedingTest : public ::testing::TestWithParam<std::vector<const char*>> {
 protected:
  void SetUp() override {
    const char* data = std::getenv("TRAPEZE_DATA");
    if (data == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
    std::vector<std::string> files;
    for (const char* name : GetParam()) files.push_back(std::filesystem::path(data) / name);
    dataset_ = Dataset::load(layers_of_files(files));
  }

  void expect_served(const std::string& style, ZoomRange zooms, const GeographicBounds& box) {
    SCOPED_TRACE(style);
    SeedRequest request = testing::seed_request(*dataset_, zooms, style);
    request.bbox = box;
    const auto plan = SeedPlan::make(request, dataset_);
    testing::expect_served_bytes(*plan);
  }

  std::shared_ptr<const Dataset> dataset_;
};

constexpr const char* kStyles[] = {"", "fill-opacity=0.4&stroke=black&stroke-width=3",
                                   "small=keep&fill-opacity=0.6", "fill=none&stroke=black"};

TEST_P(RealSeedingTest, AllOfItFromAfarIsWhatTheServerAnswersWith) {
  Box box;
  for (const ServedLayer& served : dataset_->layers()) box.include(served.layer->bounds());
  const GeographicBounds bounds = bounds_in_degrees(box);
  const int zoom = zoom_of_width(bounds[2] - bounds[0]);
  for (const char* style : kStyles) expect_served(style, {zoom, zoom + 3}, bounds);
}

TEST_P(RealSeedingTest, WhatLiesAroundAPolygonIsWhatTheServerAnswersWith) {
  constexpr double kDegrees = 0.008;
  const MeshView& mesh = dataset_->layers()[0].layer->mesh();
  const Point middle = mesh.vertices[mesh.vertices.size() / 2];
  const auto [lon, lat] = lonlat_from_grid(middle.x, middle.y);
  for (const char* style : kStyles) {
    expect_served(style, {13, 18},
                  {lon - kDegrees, lat - kDegrees, lon + kDegrees, lat + kDegrees});
  }
}

INSTANTIATE_TEST_SUITE_P(
    Files, RealSeedingTest,
    ::testing::Values(std::vector{"malta_landuse.fgb"}, std::vector{"us_counties.fgb"},
                      std::vector{"lands_complex.fgb"}, std::vector{"shenzhen_buildings.fgb"},
                      std::vector{"melbourne_natural.fgb", "melbourne_landuse.fgb"},
                      std::vector{"malta_landuse.fgb", "malta_natural.fgb", "malta_buildings.fgb"}),
    [](const auto& files) {
      return std::filesystem::path(files.param.back()).stem().string() +
             std::to_string(files.param.size());
    });

}  // namespace
}  // namespace trapeze
