// Polygons on grids of other reference systems, compared with PROJ along their edges.
#include "core/io/source/target_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <ogr_geometry.h>

#include "core/borders/part_union.h"
#include "core/grid/ring_box.h"
#include "core/io/source/ring_reader.h"
#include "tests/core/io/source/written_source.h"

namespace trapeze {
namespace {

FeatureRings read_on_grid(const std::string& wkt, const std::string& crs, const std::string& grid) {
  const OGRSpatialReference reference = test_reference(crs);
  const SourceCrs described = SourceCrs::describe(&reference);
  OGRGeometry* geometry = nullptr;
  EXPECT_EQ(OGRGeometryFactory::createFromWkt(wkt.c_str(), nullptr, &geometry), OGRERR_NONE);
  const std::unique_ptr<OGRGeometry> owned(geometry);
  FeatureRings feature;
  RingReader(described, {.grid = find_target_grid(grid)}).read(*owned, feature);
  EXPECT_EQ(feature.failure, "");
  return feature;
}

std::string square(double west, double south, double east, double north) {
  const auto n = [](double v) { return std::to_string(v); };
  return "POLYGON((" + n(west) + " " + n(south) + "," + n(east) + " " + n(south) + "," + n(east) +
         " " + n(north) + "," + n(west) + " " + n(north) + "," + n(west) + " " + n(south) + "))";
}

double distance_to_ring(double x, double y, std::span<const Point> ring) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point a = ring[i];
    const Point b = ring[(i + 1) % ring.size()];
    least =
        std::min(least, distance_on_plane({x, y}, {1.0 * a.x, 1.0 * a.y}, {1.0 * b.x, 1.0 * b.y}));
  }
  return least;
}

TEST(TargetGridTest, PlacesAreWhereTheSystemHasThem) {
  // The old observatory of Bern is the origin of the Swiss grid.
  const auto grid = find_target_grid("EPSG:2056");
  GridTransform transform(*grid);
  std::vector<double> x = {7.438632495};
  std::vector<double> y = {46.951082877};
  ASSERT_TRUE(transform.to_cells(x, y));
  const double units = grid->cells_per_unit();
  EXPECT_NEAR(grid->middle_x + x[0] / units, 2'600'000, 2);
  EXPECT_NEAR(grid->middle_y - y[0] / units, 1'200'000, 2);
  ASSERT_TRUE(transform.to_lonlat(x, y));
  EXPECT_NEAR(x[0], 7.438632495, 1e-7);
  EXPECT_NEAR(y[0], 46.951082877, 1e-7);
  EXPECT_LT(grid->metres_per_cell(), 0.001) << "the area of use is small";
}

TEST(TargetGridTest, KnowsTheOrderOfAxes) {
  EXPECT_FALSE(find_target_grid("EPSG:2056")->is_north_first);
  EXPECT_FALSE(find_target_grid("EPSG:27700")->is_north_first);
  EXPECT_FALSE(find_target_grid("EPSG:5042")->is_north_first);
  EXPECT_TRUE(find_target_grid("EPSG:3035")->is_north_first);
}

TEST(TargetGridTest, GoesAllTheWayRoundAPole) {
  EXPECT_TRUE(find_target_grid("EPSG:5041")->goes_around());
  EXPECT_EQ(find_target_grid("EPSG:5041")->north, 90);
  EXPECT_FALSE(find_target_grid("EPSG:3035")->goes_around());
}

TEST(TargetGridTest, RefusesWhatIsNoPlaneOrNotKnown) {
  for (const auto& [name, words] :
       {std::pair("EPSG:4326", "is no system of a plane"),
        std::pair("EPSG:99999", "that PROJ does not know"),
        std::pair("ESRI:53036", "not without a break"),
        std::pair("+proj=merc", "is not the name of a reference system"),
        std::pair("/etc/passwd", "is not the name of a reference system")}) {
    try {
      find_target_grid(name);
      FAIL() << name;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(),
                  ::testing::AllOf(::testing::StartsWith(name), ::testing::HasSubstr(words)));
    }
  }
}

// Equal Earth for the Americas is the world from 90 degrees east to 90 degrees east.
TEST(TargetGridTest, EndsWhereThePlaneIsTorn) {
  const auto grid = find_target_grid("EPSG:8858");
  EXPECT_NEAR(grid->west, 90, 0.1);
  EXPECT_NEAR(grid->east, 450, 0.1);
}

TEST(TargetGridTest, KeepsWhatPolygonsLongerThanTheWorldCoverTwice) {
  // Around the pole, and a strip across the antimeridian.
  for (const char* grid : {"EPSG:3995", "EPSG:2193"}) {
    const bool is_north = std::string(grid) == "EPSG:3995";
    const double south = is_north ? 65 : -50;
    const auto area_of = [&](double west, double east) {
      FeatureRings feature = read_on_grid(square(west, south, east, south + 10), "EPSG:4326", grid);
      unite_parts(feature.rings, feature.part_ends);
      double area = 0;  // the ring of a pole lies within another one
      for (std::size_t r = 0; r < feature.rings.size(); ++r) {
        const double ring = area_of_ring(feature.rings[r]);
        area = is_north && r > 0 ? std::abs(area - ring) : area + ring;
      }
      return area;
    };
    const double world = area_of(-180, 180);
    EXPECT_GT(world, 0);
    EXPECT_NEAR(area_of(-200, 200) / world, 1, 1e-6) << grid;
    EXPECT_NEAR(area_of(-175, 195) / world, 1, 1e-6) << grid;
  }
}

TEST(TargetGridTest, StopsShortOfThePolesOfMercator) {
  EXPECT_LT(find_target_grid("EPSG:3395")->metres_per_cell(), 0.05);
}

struct Case {
  const char* grid;
  const char* crs;  // of the source
  double west;
  double south;
  double east;
  double north;
};

class EdgesOnGridTest : public ::testing::TestWithParam<Case> {};

// Straight lines of the source, projected point by point, coincide with the edges of the ring.
TEST_P(EdgesOnGridTest, StayWhereTheyAre) {
  const Case& one = GetParam();
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const auto grid = find_target_grid(one.grid);
  const OGRSpatialReference source = test_reference(one.crs);
  const OGRSpatialReference target = test_reference(one.grid);
  const std::unique_ptr<OGRCoordinateTransformation> straight(
      OGRCreateCoordinateTransformation(&source, &target));
  ASSERT_NE(straight, nullptr);
  // The rounding to cells, and the permitted error of edges.
  const double most = std::max(0.25, GridRings::kMostOffMetres / grid->metres_per_cell()) +
                      (std::string(one.crs) == "EPSG:4326" ? 0 : 1) * GridRings::kMostOffMetres /
                          grid->metres_per_cell() +
                      0.75;
  double worst = 0;
  for (int i = 0; i < 5; ++i) {
    std::uniform_real_distribution<double> any_x(one.west, one.east);
    std::uniform_real_distribution<double> any_y(one.south, one.north);
    std::vector<std::pair<double, double>> corners;
    for (int k = 0; k < 3; ++k) corners.emplace_back(any_x(random), any_y(random));
    std::string wkt = "POLYGON((";
    char text[64];
    for (int k = 0; k <= 3; ++k) {
      const auto [x, y] = corners[static_cast<std::size_t>(k % 3)];
      std::snprintf(text, sizeof text, "%s%.12g %.12g", k == 0 ? "" : ",", x, y);
      wkt += text;
    }
    const FeatureRings feature = read_on_grid(wkt + "))", one.crs, one.grid);
    ASSERT_EQ(feature.rings.size(), 1u) << wkt;
    EXPECT_GT(feature.rings[0].size(), 3u) << "no edge was cut";
    for (int k = 0; k < 3; ++k) {
      const auto [x0, y0] = corners[static_cast<std::size_t>(k)];
      const auto [x1, y1] = corners[static_cast<std::size_t>((k + 1) % 3)];
      for (int part = 0; part <= 40; ++part) {
        double x = x0 + (x1 - x0) * part / 40;
        double y = y0 + (y1 - y0) * part / 40;
        ASSERT_TRUE(straight->Transform(1, &x, &y));
        const double cell_x = (x - grid->middle_x) * grid->cells_per_unit();
        const double cell_y = (grid->middle_y - y) * grid->cells_per_unit();
        worst = std::max(worst, distance_to_ring(cell_x, cell_y, feature.rings[0]));
      }
    }
  }
  EXPECT_LE(worst, most);
  std::printf("%s of %s: %.3f cells off, %.2f mm\n", one.grid, one.crs, worst,
              1000 * worst * grid->metres_per_cell());
}

INSTANTIATE_TEST_SUITE_P(Systems, EdgesOnGridTest,
                         ::testing::Values(Case{"EPSG:2056", "EPSG:4326", 6.2, 45.9, 10.3, 47.7},
                                           Case{"EPSG:27700", "EPSG:4326", -6, 50, 1.5, 58},
                                           Case{"EPSG:28992", "EPSG:4326", 3.4, 50.8, 7, 53.4},
                                           Case{"EPSG:25832", "EPSG:4326", 6, 47.5, 14, 55},
                                           Case{"EPSG:3035", "EPSG:4326", -9, 36, 30, 70},
                                           Case{"EPSG:5042", "EPSG:4326", -170, -85, 170, -62},
                                           Case{"EPSG:3035", "EPSG:3857", -1e6, 4.5e6, 3e6, 1e7},
                                           Case{"EPSG:25832", "EPSG:3035", 4.1e6, 2.7e6, 4.6e6,
                                                3.4e6}),
                         [](const auto& test) {
                           std::string name =
                               std::string(test.param.grid) + "_of_" + test.param.crs;
                           std::ranges::replace(name, ':', '_');
                           return name;
                         });

TEST(GridRingsTest, NeighboursCutTheirCommonEdgeAlike) {
  const FeatureRings west =
      read_on_grid("POLYGON((5 45,10 45,11 50,5 50,5 45))", "EPSG:4326", "EPSG:3035");
  const FeatureRings east =
      read_on_grid("POLYGON((10 45,15 45,15 50,11 50,10 45))", "EPSG:4326", "EPSG:3035");
  const auto points_of = [](const FeatureRings& feature) {
    std::set<std::pair<int, int>> points;
    for (const Point p : feature.rings[0]) points.emplace(p.x, p.y);
    return points;
  };
  const auto a = points_of(west);
  const auto b = points_of(east);
  std::vector<std::pair<int, int>> common;
  std::ranges::set_intersection(a, b, std::back_inserter(common));
  EXPECT_GT(common.size(), 20u);
  // Every vertex of one on the shared edge is also a vertex of the other.
  const auto [west_end, east_end] = std::minmax(common.front(), common.back());
  EXPECT_NE(west_end, east_end);
}

TEST(GridRingsTest, WhatLiesBeyondTheAreaIsCutOff) {
  const FeatureRings world = read_on_grid(square(-179, -89, 179, 89), "EPSG:4326", "EPSG:2056");
  ASSERT_EQ(world.rings.size(), 1u);
  for (const Point p : world.rings[0]) {
    EXPECT_GE(std::min(p.x, p.y), kGridMin);
    EXPECT_LE(std::max(p.x, p.y), kGridMax);
  }
  EXPECT_EQ(read_on_grid(square(100, -50, 110, -40), "EPSG:4326", "EPSG:2056").rings.size(), 0u);
}

// Both sides of the antimeridian have the same points along it.
TEST(GridRingsTest, TheSeamIsCutAlikeOnBothSides) {
  for (const char* grid : {"EPSG:32760", "EPSG:5042", "EPSG:3832"}) {
    const bool is_polar = std::string(grid) == "EPSG:5042";
    const double south = is_polar ? -80 : -18.3;
    const double north = is_polar ? -75 : -16.1;
    const FeatureRings west = read_on_grid(square(178, south, 180, north), "EPSG:4326", grid);
    const FeatureRings east = read_on_grid(square(-180, south, -178, north), "EPSG:4326", grid);
    ASSERT_EQ(west.rings.size(), 1u) << grid;
    ASSERT_EQ(east.rings.size(), 1u) << grid;
    std::set<std::pair<int, int>> points;
    for (const Point p : west.rings[0]) points.emplace(p.x, p.y);
    std::size_t common = 0;
    for (const Point p : east.rings[0]) common += points.count({p.x, p.y});
    EXPECT_GE(common, static_cast<std::size_t>((north - south) * 256)) << grid;
  }
}

}  // namespace
}  // namespace trapeze
