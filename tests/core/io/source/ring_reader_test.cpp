#include "core/io/source/ring_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/borders/part_union.h"
#include "core/grid/web_mercator.h"
#include "tests/core/io/source/written_source.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

SourceCrs crs_of(const std::string& name) {
  if (name.empty()) return SourceCrs::describe(nullptr);
  const OGRSpatialReference reference = test_reference(name);
  return SourceCrs::describe(&reference);
}

std::unique_ptr<OGRGeometry> geometry_of(const std::string& wkt) {
  OGRGeometry* geometry = nullptr;
  EXPECT_EQ(OGRGeometryFactory::createFromWkt(wkt.c_str(), nullptr, &geometry), OGRERR_NONE);
  return std::unique_ptr<OGRGeometry>(geometry);
}

FeatureRings read(const std::string& wkt, const SourceCrs& crs, RingReader::Options options = {}) {
  FeatureRings feature;
  RingReader(crs, options).read(*geometry_of(wkt), feature);
  return feature;
}

FeatureRings read(const std::string& wkt, const std::string& crs = "OGC:CRS84") {
  return read(wkt, crs_of(crs));
}

std::vector<Point> ring(const FeatureRings& feature, std::size_t i) {
  return {feature.rings[i].begin(), feature.rings[i].end()};
}

// The sum itself fits into 64 bits; intermediate results may wrap around.
std::int64_t twice_area(std::span<const Point> ring) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point a = ring[i];
    const Point b = ring[(i + 1) % ring.size()];
    sum += static_cast<std::uint64_t>(std::int64_t{a.x} * b.y - std::int64_t{b.x} * a.y);
  }
  return std::abs(static_cast<std::int64_t>(sum));
}

Box bounds(const FeatureRings& feature) {
  Box box;
  for (const Point p : feature.rings.points) box.include(p);
  return box;
}

Point snapped(GridPosition p) {
  return {static_cast<std::int32_t>(std::lrint(p.x)), static_cast<std::int32_t>(std::lrint(p.y))};
}

Point at(double lon, double lat) {
  return snapped(grid_from_lonlat({lon, lat}));
}

// The grid cell computed by PROJ alone, along the path that GDAL itself would take to EPSG:3857.
std::vector<Point> by_proj(const std::string& crs, std::vector<double> x, std::vector<double> y) {
  const OGRSpatialReference source = test_reference(crs);
  const OGRSpatialReference target = test_reference("EPSG:3857");
  const std::unique_ptr<OGRCoordinateTransformation> transformation(
      OGRCreateCoordinateTransformation(&source, &target));
  EXPECT_TRUE(transformation->Transform(static_cast<int>(x.size()), x.data(), y.data()));
  std::vector<Point> points;
  for (std::size_t i = 0; i < x.size(); ++i)
    points.push_back(snapped(grid_from_metres(x[i], y[i])));
  return points;
}

struct RandomPoints {
  std::vector<double> x;
  std::vector<double> y;
};

RandomPoints random_points(int count, double min_x, double max_x, double min_y, double max_y) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(min_x, max_x);
  std::uniform_real_distribution<double> y(min_y, max_y);
  RandomPoints points;
  for (int i = 0; i < count; ++i) {
    points.x.push_back(x(random));
    points.y.push_back(y(random));
  }
  return points;
}

std::vector<Point> by_reader(const std::string& crs, const RandomPoints& points) {
  OGRPolygon polygon;
  auto* line = new OGRLinearRing;
  line->setPoints(static_cast<int>(points.x.size()), points.x.data(), points.y.data());
  line->closeRings();
  polygon.addRingDirectly(line);
  FeatureRings feature;
  const SourceCrs source = crs_of(crs);
  RingReader(source, {}).read(polygon, feature);
  EXPECT_EQ(feature.failure, "");
  return feature.rings.points;
}

std::int64_t twice_area(const FeatureRings& feature) {
  std::int64_t area = 0;
  for (std::size_t i = 0; i < feature.rings.size(); ++i) area += twice_area(feature.rings[i]);
  return area;
}

// A rectangle on a plane whose edges are divided into `parts`.
std::string rectangle(double west, double south, double east, double north, int parts) {
  const double x[] = {west, east, east, west, west};
  const double y[] = {south, south, north, north, south};
  std::string wkt = "POLYGON((";
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < parts; ++i) {
      const double share = static_cast<double>(i) / parts;
      wkt += std::to_string(x[side] + (x[side + 1] - x[side]) * share) + " " +
             std::to_string(y[side] + (y[side + 1] - y[side]) * share) + ",";
    }
  }
  return wkt + std::to_string(west) + " " + std::to_string(south) + "))";
}

// Two intermediate roundings may put a point between two cells into either of them.
std::size_t count_different(const std::vector<Point>& a, const std::vector<Point>& b,
                            int by_more_than) {
  EXPECT_EQ(a.size(), b.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    count += std::abs(a[i].x - b[i].x) > by_more_than || std::abs(a[i].y - b[i].y) > by_more_than;
  }
  return count;
}

TEST(SourceCrsTest, RecognizesWhatNeedsNoProj) {
  using Kind = SourceCrs::Kind;
  EXPECT_EQ(crs_of("EPSG:4326").kind, Kind::degrees);
  EXPECT_EQ(crs_of("OGC:CRS84").kind, Kind::degrees);
  EXPECT_EQ(crs_of("EPSG:3857").kind, Kind::web_mercator);
  EXPECT_EQ(crs_of("EPSG:4269").kind, Kind::geographic);
  EXPECT_EQ(crs_of("EPSG:25832").kind, Kind::projected);
  EXPECT_EQ(crs_of("").kind, Kind::assumed_degrees);
}

TEST(SourceCrsTest, RecognizesWgs84WithoutItsNumber) {
  EXPECT_EQ(crs_of("GEOGCS[\"GCS_WGS_1984\",DATUM[\"WGS_1984\",SPHEROID[\"WGS_1984\",6378137,"
                   "298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]")
                .kind,
            SourceCrs::Kind::degrees);
}

TEST(RingReaderTest, DegreesFallIntoTheCellsOfProj) {
  const RandomPoints points = random_points(100'000, -180, 180, -85, 85);
  EXPECT_EQ(
      count_different(by_reader("EPSG:4326", points), by_proj("EPSG:4326", points.x, points.y), 0),
      0u);
}

TEST(RingReaderTest, MetresOfWebMercatorFallIntoTheirCells) {
  const RandomPoints points = random_points(10'000, -2e7, 2e7, -2e7, 2e7);
  EXPECT_EQ(
      count_different(by_reader("EPSG:3857", points), by_proj("EPSG:3857", points.x, points.y), 0),
      0u);
}

TEST(RingReaderTest, ProjectedSourcesFallIntoTheCellsOfProj) {
  const RandomPoints points = random_points(10'000, 300'000, 700'000, 5'300'000, 6'000'000);
  const auto ours = by_reader("EPSG:25832", points);
  const auto theirs = by_proj("EPSG:25832", points.x, points.y);
  EXPECT_EQ(count_different(ours, theirs, 1), 0u);
  EXPECT_LE(count_different(ours, theirs, 0), 5u);
}

TEST(RingReaderTest, OtherDatumsAreShiftedAsByProj) {
  const RandomPoints points = random_points(1'000, 6, 14, 48, 54);
  const auto ours = by_reader("EPSG:4314", points);
  EXPECT_EQ(count_different(ours, by_proj("EPSG:4314", points.x, points.y), 1), 0u);
  // The German datum differs from WGS 84 by some hundred metres, so this proves that PROJ was used.
  EXPECT_EQ(count_different(ours, by_proj("EPSG:4326", points.x, points.y), 1000), 1000u);
}

TEST(RingReaderTest, FollowsTheAxisOrderThatTheSourceStates) {
  OGRSpatialReference latitude_first;
  latitude_first.importFromEPSG(4326);
  latitude_first.SetAxisMappingStrategy(OAMS_AUTHORITY_COMPLIANT);
  const SourceCrs crs = SourceCrs::describe(&latitude_first);
  const FeatureRings feature = read("POLYGON((47 9,47 10,48 10,47 9))", crs);
  EXPECT_EQ(ring(feature, 0), ring(read("POLYGON((9 47,10 47,10 48,9 47))"), 0));
}

TEST(RingReaderTest, DropsTheClosingVertexAndDuplicates) {
  const FeatureRings feature = read("POLYGON((1 1,1 1,2 1,2 1,2 2,2 2,1 1,1 1))");
  EXPECT_THAT(ring(feature, 0), ElementsAre(at(1, 1), at(2, 1), at(2, 2)));
  EXPECT_EQ(feature.vertices, 8u);
}

TEST(RingReaderTest, KeepsAllRingsInTheirOrderAndCountsThem) {
  const FeatureRings feature =
      read("MULTIPOLYGON(((0 0,9 0,9 9,0 0),(1 1,2 1,2 2,1 1)),((20 0,21 0,21 1,20 0)),EMPTY)");
  ASSERT_EQ(feature.rings.size(), 3u);
  EXPECT_THAT(ring(feature, 1), ElementsAre(at(1, 1), at(2, 1), at(2, 2)));
  EXPECT_THAT(ring(feature, 2), ElementsAre(at(20, 0), at(21, 0), at(21, 1)));
  EXPECT_EQ(feature.polygons, 2u);
  EXPECT_EQ(feature.source_rings, 3u);
  EXPECT_EQ(feature.vertices, 12u);
}

TEST(RingReaderTest, CountsShellsByDirectionWhereTheFormatDefinesIt) {
  const FeatureRings feature =
      read("MULTIPOLYGON(((0 0,9 9,9 0,0 0)),((5 1,6 1,6 2,5 1)),((20 0,21 1,21 0,20 0)))",
           crs_of("EPSG:4326"), {.shells_are_clockwise = true});
  EXPECT_EQ(feature.polygons, 2u);
  EXPECT_EQ(feature.source_rings, 3u);
}

TEST(RingReaderTest, TakesCollectionsApartAndLeavesPointsAndLines) {
  const FeatureRings feature = read(
      "GEOMETRYCOLLECTION(POINT(0 0),LINESTRING(0 0,1 1),POLYGON((1 1,2 1,2 2,1 1)),"
      "GEOMETRYCOLLECTION(MULTIPOLYGON(((3 1,4 1,4 2,3 1)))))");
  EXPECT_EQ(feature.polygons, 2u);
  EXPECT_EQ(feature.rings.size(), 2u);
}

TEST(RingReaderTest, IgnoresHeightAndMeasure) {
  EXPECT_EQ(ring(read("POLYGON ZM((1 1 5 6,2 1 5 6,2 2 5 6,1 1 5 6))"), 0),
            ring(read("POLYGON((1 1,2 1,2 2,1 1))"), 0));
}

TEST(RingReaderTest, ReadsTheFacesOfSurfaces) {
  EXPECT_EQ(read("TIN(((0 0,1 0,1 1,0 0)),((5 0,6 0,6 1,5 0)))").polygons, 2u);
  EXPECT_EQ(read("POLYHEDRALSURFACE(((0 0,1 0,1 1,0 0)))").polygons, 1u);
  EXPECT_EQ(read("TRIANGLE((0 0,1 0,1 1,0 0))").polygons, 1u);
}

TEST(RingReaderTest, MakesCurvesLinear) {
  const FeatureRings feature =
      read("CURVEPOLYGON(CIRCULARSTRING(1000 0,0 1000,-1000 0,0 -1000,1000 0))", "EPSG:3857");
  ASSERT_EQ(feature.rings.size(), 1u);
  const double radius = grid_from_metres(1000, 0).x;
  EXPECT_NEAR(static_cast<double>(twice_area(feature.rings[0])) / (2 * radius * radius), 3.1416,
              0.01);
  EXPECT_EQ(read("MULTISURFACE(CURVEPOLYGON(CIRCULARSTRING(1 0,0 1,-1 0,0 -1,1 0)),"
                 "((5 0,6 0,6 1,5 0)))")
                .polygons,
            2u);
}

TEST(RingReaderTest, SaysWhenACoordinateIsNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()}) {
    const std::unique_ptr<OGRGeometry> geometry = geometry_of("POLYGON((1 1,2 1,2 2,1 1))");
    geometry->toPolygon()->getExteriorRing()->setPoint(1, 2, bad);
    FeatureRings feature;
    const SourceCrs crs = crs_of("EPSG:4326");
    RingReader(crs, {}).read(*geometry, feature);
    EXPECT_THAT(feature.failure, HasSubstr("not a finite number"));
    EXPECT_TRUE(feature.rings.empty());
  }
}

TEST(RingReaderTest, TakesNumbersWithoutCrsForDegreesOnlyIfTheyCanBe) {
  const FeatureRings degrees = read("POLYGON((1 1,2 1,2 2,1 1))", "");
  EXPECT_THAT(ring(degrees, 0), ElementsAre(at(1, 1), at(2, 1), at(2, 2)));
  const FeatureRings metres = read("POLYGON((1 1,2 1,2 500,1 1))", "");
  EXPECT_TRUE(metres.has_wrong_units);
  EXPECT_TRUE(metres.rings.empty());
}

// GeoJSON is in degrees unless the file states otherwise, but is often written in metres.
TEST(RingReaderTest, SaysWhenNothingIsLeftOfAFeatureAsItsCoordinatesAreNotDegrees) {
  const char* metres = "POLYGON((500000 5500000,501000 5500000,501000 5501000,500000 5500000))";
  for (const char* crs : {"OGC:CRS84", "EPSG:4326", "EPSG:4258"}) {
    SCOPED_TRACE(crs);
    const FeatureRings feature = read(metres, crs);
    EXPECT_THAT(feature.failure, HasSubstr("not degrees"));
    EXPECT_TRUE(feature.rings.empty());
  }
  EXPECT_THAT(read("POLYGON((600 0,601 0,601 1,600 0))").failure, HasSubstr("not degrees"));
  // These are accepted: they are outside of every map, or too small.
  EXPECT_EQ(read("POLYGON((0 86,1 90,2 87,0 86))").failure, "");
  EXPECT_EQ(read("POLYGON EMPTY").failure, "");
  // A part of this one can be drawn.
  EXPECT_EQ(read("POLYGON((0 80,1 80,1 500,0 80))").failure, "");
  EXPECT_EQ(read("POLYGON((0 80,1 80,1 500,0 80))").rings.size(), 1u);
}

TEST(RingReaderTest, ReportsPointsThatCannotBeReprojected) {
  // Far outside the range to which a transverse Mercator zone can be extended.
  const FeatureRings feature = read("POLYGON((500000 0,1e12 0,1e12 1e12,500000 0))", "EPSG:25832");
  EXPECT_THAT(feature.failure, HasSubstr("cannot be reprojected"));
  EXPECT_TRUE(feature.rings.empty());
}

TEST(RingReaderTest, ClipsAtTheEndOfTheSquareTowardsThePoles) {
  const FeatureRings feature = read("POLYGON((-180 -90,180 -90,180 -80,-180 -80,-180 -90))");
  ASSERT_EQ(feature.rings.size(), 1u);
  const Box box = bounds(feature);
  EXPECT_EQ(box.min_x, kGridMin);
  EXPECT_EQ(box.max_x, kGridMax);
  EXPECT_EQ(box.min_y, at(0, -80).y);
  EXPECT_EQ(box.max_y, kGridMax);
  EXPECT_EQ(twice_area(feature.rings[0]), 2 * kGridSize * (std::int64_t{box.max_y} - box.min_y));
  EXPECT_EQ(bounds(read("POLYGON((0 80,1 90,2 80,0 80))")).min_y, kGridMin);
}

TEST(RingReaderTest, LeavesNothingOfWhatLiesBeyondTheSquare) {
  EXPECT_TRUE(read("POLYGON((0 86,1 90,2 87,0 86))").rings.empty());
  EXPECT_TRUE(read("POLYGON((600 0,601 0,601 1,600 0))").rings.empty());
}

TEST(RingReaderTest, BringsWhatLiesBeyondTheAntimeridianInOnTheOtherSide) {
  const FeatureRings feature = read("POLYGON((179 0,182 0,182 1,179 1,179 0))");
  ASSERT_EQ(feature.rings.size(), 2u);
  const FeatureRings east = read("POLYGON((179 0,180 0,180 1,179 1,179 0))");
  const FeatureRings west = read("POLYGON((-180 0,-178 0,-178 1,-180 1,-180 0))");
  EXPECT_EQ(twice_area(feature.rings[0]), twice_area(east.rings[0]));
  EXPECT_EQ(twice_area(feature.rings[1]), twice_area(west.rings[0]));
  EXPECT_EQ(read("POLYGON((-182 0,-179 0,-179 1,-182 1,-182 0))").rings.size(), 2u);
}

TEST(RingReaderTest, MakesAPartOfEachTurnOfWhatIsLongerThanTheWorld) {
  FeatureRings feature = read("POLYGON((-190 0,190 0,190 1,-190 1,-190 0))");
  EXPECT_THAT(feature.part_ends, ElementsAre(1u, 2u, 3u));
  EXPECT_TRUE(unite_parts(feature.rings, feature.part_ends).did_overlap);
  const FeatureRings world = read("POLYGON((-180 0,180 0,180 1,-180 1,-180 0))");
  ASSERT_EQ(feature.rings.size(), 1u);
  EXPECT_EQ(std::abs(twice_area(feature.rings[0])), std::abs(twice_area(world.rings[0])));
  // A hole stays in the turn in which it lies.
  const FeatureRings with_hole =
      read("POLYGON((-190 0,190 0,190 1,-190 1,-190 0),(5 0.2,6 0.2,6 0.8,5 0.2))");
  EXPECT_THAT(with_hole.part_ends, ElementsAre(2u, 3u, 4u));
}

TEST(RingReaderTest, LaysCutsThatAreRoundedOnTheAntimeridian) {
  const auto same = [](const char* text, const char* other) {
    return std::ranges::equal(read(text).rings.points, read(other).rings.points);
  };
  const char* exact = "POLYGON((170 -80,180 -80,180 -70,170 -70,170 -80))";
  EXPECT_TRUE(same("POLYGON((170 -80,179.99999 -80,180 -70,170 -70,170 -80))", exact));
  EXPECT_TRUE(same("POLYGON((170 -80,179.99999 -80,179.999985 -70,170 -70,170 -80))", exact));
  EXPECT_TRUE(same("POLYGON((170 -80,180.00001 -80,180 -70,170 -70,170 -80))", exact));
  EXPECT_FALSE(same("POLYGON((170 -80,179.9999 -80,180 -70,170 -70,170 -80))", exact));
  // A building beside the antimeridian stays where it is.
  EXPECT_FALSE(same("POLYGON((179.9 0,179.99999 0,179.99999 0.005,179.9 0.005,179.9 0))",
                    "POLYGON((179.9 0,180 0,180 0.005,179.9 0.005,179.9 0))"));
}

TEST(RingReaderTest, KeepsAProjectedRingAcrossTheAntimeridianTogether) {
  // In UTM zone 60 the antimeridian runs through x = 834 km at the equator.
  const FeatureRings feature =
      read("POLYGON((800000 100000,900000 100000,900000 200000,800000 200000,800000 100000))",
           "EPSG:32660");
  ASSERT_EQ(feature.rings.size(), 2u);
  const double side = grid_from_metres(100'000, 0).x;
  const double area =
      0.5 * static_cast<double>(twice_area(feature.rings[0]) + twice_area(feature.rings[1]));
  EXPECT_NEAR(area / (side * side), 1, 0.01);
}

// For example that of the sea in a world map that was vectorized from a raster.
TEST(RingReaderTest, LeadsLongEdgesAsFarAroundTheWorldAsTheyGoOnThePlane) {
  struct Case {
    const char* crs;
    double x;
    double y;
  };
  for (const auto& [crs, x, y] :
       {Case{"EPSG:3395", 20037508.34, 15e6}, Case{"EPSG:4087", 20037508.34, 8e6},
        Case{"EPSG:6933", 17367530.44, 7e6}, Case{"EPSG:4087", 12e6, 8e6},
        Case{"EPSG:4087", 16e6, 8e6}, Case{"+proj=eqc +lon_0=150", 15e6, 8e6},
        Case{"+proj=eqc +lon_0=150", 19.9e6, 8e6},
        Case{"+proj=eqc +lon_0=-100 +units=km", 15e3, 8e3}}) {
    SCOPED_TRACE(std::string(crs) + " " + std::to_string(x));
    const FeatureRings feature = read(rectangle(-x, -y, x, y, 1), crs);
    const FeatureRings by_short_edges = read(rectangle(-x, -y, x, y, 20), crs);
    ASSERT_FALSE(by_short_edges.rings.empty());
    EXPECT_EQ(feature.rings.size(), by_short_edges.rings.size());
    EXPECT_EQ(bounds(feature), bounds(by_short_edges));
    EXPECT_NEAR(
        static_cast<double>(twice_area(feature)) / static_cast<double>(twice_area(by_short_edges)),
        1, 1e-6);
  }
}

// Where parallels are shorter towards the poles, sides that are straight on the plane are not
// straight in the world, so only corners are compared.
TEST(RingReaderTest, FollowsLongEdgesOnPlanesWithCurvedMeridians) {
  for (const char* crs : {"ESRI:54009", "ESRI:54030", "EPSG:8857"}) {
    SCOPED_TRACE(crs);
    const FeatureRings feature = read(rectangle(-10e6, -5e6, 10e6, 5e6, 1), crs);
    ASSERT_EQ(feature.rings.size(), 1u);
    const Box box = bounds(feature);
    EXPECT_EQ(box.min_x, -box.max_x);
    EXPECT_GT(box.max_x, at(100, 0).x);
    EXPECT_GT(static_cast<double>(twice_area(feature)),
              2 * 1.9 * at(100, 0).x * (box.max_y - box.min_y));
  }
}

TEST(RingReaderTest, KeepsAnOtherDatumAtTheAntimeridianTogether) {
  const FeatureRings feature = read("POLYGON((179 60,180 60,180 61,179 61,179 60))", "EPSG:4267");
  const FeatureRings wgs84 = read("POLYGON((179 60,180 60,180 61,179 61,179 60))");
  EXPECT_NEAR(static_cast<double>(twice_area(feature)) / static_cast<double>(twice_area(wgs84)), 1,
              0.001);
}

TEST(RingReaderTest, LeadsARingAroundAPoleOverThePole) {
  // A square around the south pole in polar stereographic coordinates.
  const FeatureRings feature =
      read("POLYGON((-3e6 -3e6,3e6 -3e6,3e6 3e6,-3e6 3e6,-3e6 -3e6))", "EPSG:3031");
  ASSERT_FALSE(feature.rings.empty());
  const Box box = bounds(feature);
  EXPECT_EQ(box.min_x, kGridMin);
  EXPECT_EQ(box.max_x, kGridMax);
  EXPECT_EQ(box.max_y, kGridMax);
  const double least = static_cast<double>(kGridSize) * (kGridMax - at(0, -62).y);
  EXPECT_GT(0.5 * static_cast<double>(twice_area(feature)), 0.5 * least);
}

TEST(HasPolygonsTest, LooksIntoCollections) {
  EXPECT_TRUE(
      has_polygons(*geometry_of("GEOMETRYCOLLECTION(POINT(0 0),GEOMETRYCOLLECTION(POLYGON "
                                "EMPTY))")));
  EXPECT_FALSE(has_polygons(*geometry_of("GEOMETRYCOLLECTION(POINT(0 0))")));
  EXPECT_FALSE(has_polygons(*geometry_of("MULTILINESTRING((0 0,1 1))")));
  EXPECT_TRUE(has_polygons(*geometry_of("MULTIPOLYGON EMPTY")));
}

}  // namespace
}  // namespace trapeze
