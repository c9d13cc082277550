// Polygons exported with round corners (see round_corners()).
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "core/io/export/export_layer.h"
#include "tests/core/io/export/exported_cells.h"
#include "tests/core/io/export/reshaped_export.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {
namespace {

using testing::doubled_area;

class SmoothExportTest : public testing::ReshapedExportTest {
 protected:
  SmoothExportTest() { options_.smooth = {8, 256}; }  // for up to 38 m
};

std::size_t points_of(const Rings& rings) {
  return rings.points.size();
}

TEST_F(SmoothExportTest, NothingChangesWithoutARadius) {
  set_source({"(0 0,900 0,1000 500,900 1000,0 1000,0 0),(300 300,600 300,500 600,300 300)"});
  std::vector<std::string> files;
  for (const RoundingSize& size : {RoundingSize{}, RoundingSize{0, 256}, RoundingSize{8, 256}}) {
    options_.smooth = size;
    files.push_back(write_text());
    EXPECT_EQ(report_.corners.rounded, size.radius > 0 ? 8u : 0u);
    EXPECT_EQ(report_.vertices, 8u);
  }
  EXPECT_EQ(files[0], files[1]);
  EXPECT_NE(files[0], files[2]);
}

TEST_F(SmoothExportTest, NeighboursLeaveNoGapAndDoNotOverlap) {
  set_source({"(0 0,500 0,520 100,480 200,500 300,470 400,500 600,0 600,0 0)",
              "(1000 0,1000 600,500 600,470 400,500 300,480 200,520 100,500 0,1000 0)"});
  const std::vector<Rings> neighbours = write();
  ASSERT_EQ(neighbours.size(), 2u);
  EXPECT_EQ(report_.corners.rounded, 8u);
  // Together they are the rectangle with four round corners.
  set_source({"(0 0,500 0,1000 0,1000 600,500 600,0 600,0 0)"});
  const std::vector<Rings> all = write();
  EXPECT_TRUE(doubled_area(neighbours) == doubled_area(all));
  const testing::SegmentCounts segments = testing::segments_of(neighbours);
  std::size_t outer = 0;
  for (const auto& [segment, count] : segments) outer += count == 1 ? 1 : 0;
  EXPECT_EQ(outer, points_of(all[0]));
  EXPECT_GT(segments.size() - outer, 5u * 2);
}

TEST_F(SmoothExportTest, WithoutACoverageCornersStayWhereAnotherPolygonHasAVertex) {
  options_.generalization.coverage = CoverageMode::off;
  set_source(
      {"(0 0,500 0,520 300,500 600,0 600,0 0)", "(1000 0,1000 600,500 600,520 300,500 0,1000 0)"});
  const std::vector<Rings> neighbours = write();
  EXPECT_EQ(report_.corners.rounded, 4u);
  set_source({"(0 0,500 0,1000 0,1000 600,500 600,0 600,0 0)"});
  EXPECT_TRUE(doubled_area(neighbours) == doubled_area(write()));
}

TEST_F(SmoothExportTest, PolygonsThatLieOverEachOtherStaySharp) {
  const std::string lower = "(0 0,500 0,500 600,0 600,0 0)";
  const std::string apart = "(2000 0,2500 0,2500 600,2000 600,2000 0)";
  for (const CoverageMode coverage :
       {CoverageMode::automatic, CoverageMode::on, CoverageMode::off}) {
    options_.generalization.coverage = coverage;
    set_source({lower, "(100 100,200 100,200 200,100 200,100 100)", apart});
    const std::vector<Rings> rings = write();
    ASSERT_EQ(rings.size(), 3u);
    EXPECT_EQ(report_.corners.rounded, 4u);
    EXPECT_EQ(points_of(rings[0]), 4u);
    EXPECT_EQ(points_of(rings[1]), 4u);
  }
}

TEST_F(SmoothExportTest, HolesAndWhatLiesInThemAreRoundedAlike) {
  const std::string hole = "(200 200,400 200,400 400,200 400,200 200)";
  set_source({"(0 0,600 0,600 600,0 600,0 0)," + hole, hole});
  const std::vector<Rings> rings = write();
  EXPECT_EQ(report_.corners.rounded, 8u);
  ASSERT_EQ(rings.size(), 2u);
  ASSERT_EQ(rings[0].size(), 2u);
  set_source({"(0 0,600 0,600 600,0 600,0 0)"});
  EXPECT_TRUE(doubled_area(rings) == doubled_area(write()));
}

TEST_F(SmoothExportTest, CutsAtTheAntimeridianStaySharp) {
  set_source({"(20037000 0,20037508.342789244 0,20037508.342789244 600,20037000 600,20037000 0)"});
  const std::vector<Rings> rings = write();
  EXPECT_EQ(report_.corners.rounded, 2u);
  for (const std::int32_t y : {0, -32153}) {
    EXPECT_TRUE(std::ranges::any_of(rings[0].points, [y](Point p) {
      return p.x == kGridMax && std::abs(p.y - y) < 2;
    })) << y;
  }
}

TEST_F(SmoothExportTest, InDegreesEverythingIsValidToo) {
  options_.crs = ExportCrs::degrees;
  options_.smooth.pixel = 1 << 20;
  set_source(
      {"(0 0,10000000 0,10000000 10000000,0 0),"
       "(5010000 5000000,5100000 5000000,5100000 5050000,5010000 5000000)",
       "(0 0,10000000 10000000,0 10000000,0 0)"});
  report_ = export_layer(source_, output_, options_);
  EXPECT_EQ(report_.invalid, 0u);
  EXPECT_EQ(report_.written, 2u);
  EXPECT_GT(report_.corners.rounded, 0u);
}

TEST_F(SmoothExportTest, TheOutputDoesNotDependOnTheThreads) {
  std::mt19937 random(7);
  std::vector<std::string> stars;
  for (int i = 0; i < 400; ++i) {
    std::string text;
    for (const Point p : random_star(random, {i * 400, i}, 5 + i % 60, 50, 500)) {
      text += std::to_string(p.x) + ' ' + std::to_string(p.y) + ',';
    }
    const std::string first = text.substr(0, text.find(','));
    stars.push_back("(" + text + first + ")");
  }
  set_source(stars);
  options_.epsilon = 100;
  for (const CoverageMode coverage : {CoverageMode::off, CoverageMode::on}) {
    options_.generalization.coverage = coverage;
    std::vector<std::string> files;
    for (const unsigned threads : {1u, 4u}) {
      options_.threads = threads;
      files.push_back(write_text());
    }
    EXPECT_EQ(files[0], files[1]);
  }
}

}  // namespace
}  // namespace trapeze
