#include "core/borders/rounded_polygons.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "core/grid/grid.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {
namespace {

DrawnPolygons feature(const std::string& text, std::uint32_t graph, bool is_sharp = false) {
  Rings rings = rings_from_text(text);
  DrawnPolygons result{graph, is_sharp, polygons_of(rings)};
  EXPECT_FALSE(result.polygons.empty());
  return result;
}

RoundedCorners round(std::vector<DrawnPolygons>& features, const RoundingSize& size) {
  std::vector<DrawnPolygons*> all;
  for (DrawnPolygons& each : features) all.push_back(&each);
  return round_corners(all, size, 2);
}

const std::vector<Point>& points_of(const DrawnPolygons& feature) {
  return feature.polygons.rings.points;
}

bool has_point(const DrawnPolygons& feature, Point p) {
  return std::ranges::count(points_of(feature), p) > 0;
}

TEST(RoundedPolygonsTest, CornersAreRoundedAndEdgesKeepTheirMiddles) {
  std::vector<DrawnPolygons> features{feature("0 0,1000 0,1000 1000,0 1000", 0)};
  EXPECT_EQ(round(features, {100, 1}).rounded, 4u);
  for (const Point p : {Point{0, 0}, Point{1000, 0}, Point{1000, 1000}, Point{0, 1000}}) {
    EXPECT_FALSE(has_point(features[0], p));
  }
  // The ends of the curve, and its middle at a quarter of the way from the corner to them.
  EXPECT_TRUE(has_point(features[0], {100, 0}));
  EXPECT_TRUE(has_point(features[0], {0, 100}));
  EXPECT_TRUE(has_point(features[0], {25, 25}));
  // A third of each triangle is removed.
  const auto area = static_cast<double>(doubled_area_of(features[0].polygons.rings[0]));
  EXPECT_NEAR(area / 2, 1e6 - 4 * 5000. / 3, 300);
}

TEST(RoundedPolygonsTest, HolesAndIslandsAreRoundedToo) {
  std::vector<DrawnPolygons> features{
      feature("0 0,1000 0,1000 1000,0 1000;200 200,800 200,800 800,200 800;"
              "400 400,600 400,600 600,400 600",
              0)};
  EXPECT_EQ(round(features, {50, 1}).rounded, 12u);
  EXPECT_EQ(features[0].polygons.size(), 2u);
  EXPECT_EQ(features[0].polygons.rings.size(), 3u);
}

TEST(RoundedPolygonsTest, NeighboursOfOneGraphGetTheSamePoints) {
  const std::string left = "0 0,1000 0,1200 300,900 700,1000 1000,0 1000";
  const std::string right = "2000 0,2000 1000,1000 1000,900 700,1200 300,1000 0";
  std::vector<DrawnPolygons> features{feature(left, 3), feature(right, 3)};
  // The two ends of the border stay: three edges meet there.
  EXPECT_EQ(round(features, {100, 1}).rounded, 6u);
  EXPECT_TRUE(has_point(features[0], {1000, 0}));
  EXPECT_FALSE(has_point(features[0], {1200, 300}));
  for (const Point p : points_of(features[0])) {
    EXPECT_EQ(has_point(features[1], p), p.x > 500) << p.x << ' ' << p.y;
  }
  double area = 0;
  for (const auto& each : features) {
    area += static_cast<double>(doubled_area_of(each.polygons.rings[0])) / 2;
  }
  EXPECT_NEAR(area, 2e6 - 4 * 5000. / 3, 300);
}

TEST(RoundedPolygonsTest, VerticesOfOtherGraphsKeepACornerSharp) {
  const std::string square = "0 0,1000 0,1000 1000,0 1000";
  // The corner of the other ring is within the cut-off triangle, then coincides with a corner of
  // the square.
  for (const std::string other : {"20 20,-500 10,-500 -500", "0 0,-500 10,-500 -500"}) {
    std::vector<DrawnPolygons> features{feature(square, 0), feature(other, 1)};
    round(features, {100, 1});
    EXPECT_TRUE(has_point(features[0], {0, 0}));
    EXPECT_FALSE(has_point(features[0], {1000, 0}));
  }
}

TEST(RoundedPolygonsTest, WhatIsSharpStaysAndKeepsItsNeighboursEdges) {
  std::vector<DrawnPolygons> features{feature("0 0,1000 0,1200 500,1000 1000,0 1000", 0, true),
                                      feature("2000 0,2000 1000,1000 1000,1200 500,1000 0", 0)};
  EXPECT_EQ(round(features, {100, 1}).rounded, 2u);
  EXPECT_TRUE(has_point(features[0], {1200, 500}));
  EXPECT_TRUE(has_point(features[1], {1200, 500}));
  EXPECT_FALSE(has_point(features[1], {2000, 0}));
}

TEST(RoundedPolygonsTest, CutsAtTheEdgesOfTheMapStaySharp) {
  const std::string east = std::to_string(kGridMax);
  std::vector<DrawnPolygons> features{
      feature("0 0," + east + " 0," + east + " 1000000,0 1000000", 0)};
  EXPECT_EQ(round(features, {1000, 1}).rounded, 2u);
  EXPECT_TRUE(has_point(features[0], {kGridMax, 0}));
  EXPECT_TRUE(has_point(features[0], {kGridMax, 1000000}));
  EXPECT_FALSE(has_point(features[0], {0, 0}));
}

// Half of the upper edge is less than a cell away from two triangles that touch in (750, 1). If the
// corner at its left end were rounded, the edge would begin at (500, 1) and pass through there.
TEST(RoundedPolygonsTest, ACornerStaysWhereItsEdgeWouldComeToTouchAnother) {
  const std::string above = "0 -300,1000 -300,1000 1,0 0";
  const std::string below = ";750 1,700 400,600 400;750 1,900 400,800 400";
  std::vector<DrawnPolygons> features{feature(above, 0)};
  EXPECT_EQ(round(features, {1000, 1}).refused, 0u);
  EXPECT_FALSE(has_point(features[0], {0, 0}));
  features = {feature(above + below, 0)};
  EXPECT_EQ(round(features, {1000, 1}).refused, 1u);
  EXPECT_TRUE(has_point(features[0], {0, 0}));
  EXPECT_FALSE(features[0].polygons.is_noded);
  EXPECT_EQ(features[0].polygons.size(), 3u);
}

}  // namespace
}  // namespace trapeze
