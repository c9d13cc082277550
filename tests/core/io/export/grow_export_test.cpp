// Polygons exported as wide as a style with grow draws them (see grow()).
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <ogrsf_frmts.h>

#include "core/io/export/export_layer.h"
#include "tests/core/io/export/exported_cells.h"
#include "tests/core/io/export/reshaped_export.h"

namespace trapeze {
namespace {

using testing::doubled_area;

constexpr double kMetre = 53.585;  // cells

class GrowExportTest : public testing::ReshapedExportTest {
 protected:
  GrowExportTest() { options_.grow = {4, 5 * kMetre}; }  // to 20 m

  /// The area in square metres.
  static double area(const Rings& rings) {
    return static_cast<double>(doubled_area({rings})) / 2 / kMetre / kMetre;
  }

  /// The area where two of the polygons overlap, in square metres.
  static double overlapping(const std::string& path) {
    const GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
    std::vector<std::unique_ptr<OGRGeometry>> all;
    for (const auto& feature : *dataset->GetLayer(0)) {
      all.emplace_back(feature->GetGeometryRef()->clone());
    }
    double sum = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        OGREnvelope one;
        OGREnvelope other;
        all[i]->getEnvelope(&one);
        all[k]->getEnvelope(&other);
        if (!one.Intersects(other)) continue;
        const std::unique_ptr<OGRGeometry> common(all[i]->Intersection(all[k].get()));
        if (common->getDimension() == 2) sum += common->toSurface()->get_Area();
      }
    }
    return sum;
  }
};

TEST_F(GrowExportTest, NothingChangesWithoutAWidthOrWhatIsNarrow) {
  const std::string strip = "(0 0,5 0,5 100,0 100,0 0)";
  const std::string wide = "(100 0,200 0,200 100,100 100,100 0)";
  set_source({strip, wide});
  const GrowthSize size = options_.grow;
  options_.grow = {};
  const std::string without = write_text();
  EXPECT_EQ(report_.grown, 0u);
  options_.grow.pixel = size.pixel;
  EXPECT_EQ(write_text(), without);
  options_.grow = size;
  EXPECT_NE(write_text(), without);
  EXPECT_EQ(report_.grown, 1u);
  set_source({wide});
  const std::string only_wide = write_text();
  options_.grow = {};
  EXPECT_EQ(write_text(), only_wide);
}

TEST_F(GrowExportTest, AStripIsAsWideAsAsked) {
  set_source({"(0 0,5 0,5 200,0 200,0 0)"});
  const std::vector<Rings> rings = write();
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_EQ(rings[0].size(), 1u);
  EXPECT_NEAR(area(rings[0]), 20 * 200, 30);
}

TEST_F(GrowExportTest, ARiverTakesFromItsFieldsWhatItGets) {
  // A river 6 m wide, with fields on both sides that end where it ends.
  set_source({"(0 0,600 0,600 200,550 200,400 240,200 180,50 200,0 200,0 0)",
              "(0 200,50 200,200 180,400 240,550 200,600 200,600 206,550 206,400 246,200 186,"
              "50 206,0 206,0 200)",
              "(0 206,50 206,200 186,400 246,550 206,600 206,600 400,0 400,0 206)"});
  options_.grow.width = 0;
  const std::vector<Rings> before = write();
  options_.grow.width = 4;
  const std::vector<Rings> after = write();
  ASSERT_EQ(after.size(), 3u);
  EXPECT_EQ(report_.grown, 1u);
  EXPECT_TRUE(doubled_area(after) == doubled_area(before));
  EXPECT_NEAR(area(after[1]) / area(before[1]), 20 / 6., 0.1);
  EXPECT_LT(area(after[0]), area(before[0]));
  EXPECT_LT(area(after[2]), area(before[2]));
  // The river shares its whole banks with the fields.
  for (const auto& [segment, count] : testing::segments_of({after[1]})) {
    const bool is_of_end = segment.first.x == segment.second.x;
    if (is_of_end) continue;
    EXPECT_EQ(testing::segments_of(after).at(segment), 2);
  }
}

TEST_F(GrowExportTest, WhatCrossesTheAntimeridianIsNotCovered) {
  // Three touching strips of 5, 10 and 5 m, once with the antimeridian in the middle.
  for (const double middle : {20037508.342789244, 20030000.0}) {
    const auto strip = [middle](double from, double to) {
      const std::string west = std::to_string(middle + from);
      const std::string east = std::to_string(middle + to);
      return "(" + west + " 0," + east + " 0," + east + " 100," + west + " 100," + west + " 0)";
    };
    set_source({strip(-10, -5), strip(-5, 5), strip(5, 10)});
    const std::vector<Rings> rings = write();
    ASSERT_EQ(rings.size(), 3u) << middle;
    EXPECT_EQ(report_.too_small, 0u) << middle;
    EXPECT_GE(area(rings[1]), 995) << middle;
    EXPECT_GE(area(rings[0]), 500) << middle;
  }
}

TEST_F(GrowExportTest, HousesThatGrowTowardsEachOtherShareTheVoid) {
  set_source({"(0 0,10 0,10 100,0 100,0 0)", "(14 0,24 0,24 100,14 100,14 0)"});
  const std::vector<Rings> rings = write();
  EXPECT_EQ(report_.grown, 2u);
  // 2 m to the middle, and 5 to the other side.
  for (const Rings& house : rings) EXPECT_NEAR(area(house), 17 * 100, 40);
  EXPECT_EQ(overlapping(output_), 0);
  std::size_t in_common = 0;
  for (const auto& [segment, count] : testing::segments_of(rings)) in_common += count == 2;
  EXPECT_GT(in_common, 0u);
}

TEST_F(GrowExportTest, InATownNothingIsCoveredTwice) {
  std::mt19937 random(7);
  std::vector<std::string> houses;
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 12; ++x) {
      const double angle = static_cast<double>(random() % 314) / 100;
      const double width = 5 + static_cast<double>(random() % 300) / 10;
      const double height = 3 + static_cast<double>(random() % 90) / 10;
      std::string text = "(";
      for (const int corner : {0, 1, 2, 3, 0}) {
        const double along = (corner == 1 || corner == 2 ? width : -width) / 2;
        const double across = (corner >= 2 ? height : -height) / 2;
        text += std::to_string(x * 40 + along * std::cos(angle) - across * std::sin(angle)) + ' ' +
                std::to_string(y * 40 + along * std::sin(angle) + across * std::cos(angle)) + ',';
      }
      text.back() = ')';
      houses.push_back(text);
    }
  }
  set_source(houses);
  for (const CoverageMode coverage : {CoverageMode::off, CoverageMode::automatic}) {
    options_.generalization.coverage = coverage;
    EXPECT_EQ(write().size(), houses.size());
    EXPECT_EQ(report_.grown, houses.size());
    EXPECT_LT(overlapping(output_), 1e-6);
  }
}

TEST_F(GrowExportTest, WhatLiesOverOthersStaysAsItIs) {
  set_source({"(0 0,100 0,100 100,0 100,0 0)", "(50 -50,55 -50,55 50,50 50,50 -50)",
              "(300 0,305 0,305 100,300 100,300 0)"});
  options_.grow.width = 0;
  const std::vector<Rings> before = write();
  options_.grow.width = 4;
  const std::vector<Rings> after = write();
  EXPECT_EQ(report_.grown, 1u);
  EXPECT_EQ(after[0], before[0]);
  EXPECT_EQ(after[1], before[1]);
  EXPECT_NE(after[2], before[2]);
}

// A grid of strips, many of which cross block borders.
TEST_F(GrowExportTest, DoesNotDependOnBlocksOrThreads) {
  options_.grow.pixel = kMetre;  // blocks of 512 m
  options_.grow.width = 16;
  std::vector<std::string> strips;
  for (int i = 0; i < 40; ++i) {
    const std::string at = std::to_string(i * 50 - 1000) + ' ';
    const std::string beside = std::to_string(i * 50 - 994) + ' ';
    strips.push_back("(" + at + "-1000," + beside + "-1000," + beside + "1000," + at + "1000," +
                     at + "-1000)");
  }
  set_source(strips);
  std::vector<std::string> files;
  for (const unsigned threads : {1u, 4u}) {
    options_.threads = threads;
    files.push_back(write_text());
    for (const Rings& rings : write()) EXPECT_NEAR(area(rings), 16 * 2000, 64);
  }
  EXPECT_EQ(files[0], files[1]);
}

}  // namespace
}  // namespace trapeze
