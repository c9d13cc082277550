#include "core/io/load/load_layer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "core/grid/web_mercator.h"
#include "core/io/prepared/open_layer.h"
#include "tests/core/io/source/written_source.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

const std::string kMixed = TRAPEZE_FIXTURES "/mixed.geojson";
const std::string kVillage = TRAPEZE_FIXTURES "/village.osm";

std::size_t accounted(const LoadReport& report) {
  return report.loaded + report.other_geometry + report.empty + report.skipped;
}

std::string failure_of(const std::string& path, const LoadOptions& options = {}) {
  try {
    load_layer(path, options);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "was loaded";
}

double x_at(const MeshView& mesh, const MeshEdge& edge, double y) {
  const Point upper = mesh.vertices[edge.upper];
  const Point lower = mesh.vertices[edge.lower];
  if (upper.y == lower.y) return upper.x;
  const double share = (y - upper.y) / (static_cast<double>(lower.y) - upper.y);
  return upper.x + share * (static_cast<double>(lower.x) - upper.x);
}

// The area of one feature, in cells.
double area_of(const Layer& layer, std::uint32_t row, Level level = 0) {
  std::vector<TrapezoidRange> ranges;
  layer.select({.box = {kGridMin, kGridMin, kGridMax, kGridMax}, .level = level}, ranges);
  const MeshView& mesh = layer.mesh();
  double area = 0;
  for (const TrapezoidRange range : ranges) {
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) {
      if (layer.feature_of(i) != row) continue;
      const MeshTrapezoid& t = mesh.trapezoids[i];
      const double top = mesh.vertices[t.top].y;
      const double bottom = mesh.vertices[t.bottom].y;
      if (top == bottom) continue;
      const double middle = (top + bottom) / 2;
      area += (bottom - top) *
              (x_at(mesh, mesh.edges[t.right], middle) - x_at(mesh, mesh.edges[t.left], middle));
    }
  }
  return area;
}

// The area of a rectangle in degrees on the grid, in cells.
double rectangle(double west, double south, double east, double north) {
  const GridPosition a = grid_from_lonlat({west, north});
  const GridPosition b = grid_from_lonlat({east, south});
  return (b.x - a.x) * (b.y - a.y);
}

// Snapping moves each side by at most half a cell.
void expect_area(const Layer& layer, std::uint32_t row, double expected) {
  EXPECT_NEAR(area_of(layer, row) / expected, 1, 8 / std::sqrt(expected)) << "row " << row;
}

std::string text(const Layer& layer, std::uint32_t row, const std::string& field) {
  const FeatureTable& table = layer.features();
  const Value value = table.value(row, table.field_index(field));
  return std::string(std::get<std::string_view>(value));
}

std::vector<std::string> texts(const Layer& layer, const std::string& field) {
  std::vector<std::string> all;
  for (std::uint32_t row = 0; row < layer.features().size(); ++row) {
    all.push_back(text(layer, row, field));
  }
  return all;
}

class LoadLayerTest : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
};

TEST_F(LoadLayerTest, CountsEveryFeatureOnce) {
  const LoadedLayer loaded = load_layer(kMixed);
  const LoadReport& report = loaded.report;
  EXPECT_EQ(report.path, kMixed);
  EXPECT_EQ(report.driver, "GeoJSON");
  EXPECT_EQ(report.features, 10u);
  EXPECT_EQ(report.loaded, 4u);  // square, two, collection, bow tie
  // GDAL's GeoJSON driver creates no geometry for a polygon without rings.
  EXPECT_EQ(report.other_geometry, 5u);  // point, line, nothing, no rings, only points
  EXPECT_EQ(report.empty, 1u);           // smaller than a cell
  EXPECT_EQ(report.skipped, 0u);
  EXPECT_EQ(report.polygons, 8u);
  EXPECT_EQ(report.rings, 9u);
  EXPECT_EQ(report.repaired, 1u);
  ASSERT_EQ(report.notes.size(), 3u);
  std::size_t without_geometry = 0;
  for (const FeatureNote& note : report.notes) {
    if (note.reason == "has no geometry") {
      ++without_geometry;
    } else {
      EXPECT_EQ(note.id, 15);
      EXPECT_THAT(note.reason, HasSubstr("repaired"));
    }
  }
  EXPECT_EQ(without_geometry, 2u);
}

TEST_F(LoadLayerTest, CountsALineOfAGeoJsonSequenceThatCannotBeRead) {
  const std::string square = R"({"type":"Feature","properties":{},"geometry":{"type":"Polygon",)"
                             R"("coordinates":[[[0,0],[1,0],[1,1],[0,0]]]}})";
  const std::string path =
      folder_.write("a.geojsonl", square + "\n{\"type\":\"Feature\",\"geom\n" + square + "\n");
  const LoadReport report = load_layer(path).report;
  EXPECT_EQ(report.loaded, 2u);
  EXPECT_EQ(report.skipped, 1u);
}

TEST_F(LoadLayerTest, SkipsFeaturesOfGeoJsonWhoseGeometryCannotBeRead) {
  const std::string square = R"("Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,0]]])";
  const auto feature = [](int id, const std::string& type) {
    return R"({"type":"Feature","id":)" + std::to_string(id) +
           R"(,"properties":{},"geometry":{"type":)" + type + "}}";
  };
  const std::string path = folder_.write(
      "a.geojson", R"({"type":"FeatureCollection","features":[)" + feature(1, square) + "," +
                       feature(2, R"("Polygon","coordinates":[[[0,0],["x",0],[1,1],[0,0]]])") +
                       "," + feature(3, square) + "]}");
  const LoadReport report = load_layer(path).report;
  EXPECT_EQ(report.loaded, 2u);
  EXPECT_EQ(report.skipped, 1u);
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_EQ(report.notes[0].id, 2);
  EXPECT_THAT(report.notes[0].reason, HasSubstr("coordinate"));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_THAT(report.warnings[0], HasSubstr("cannot be read as a whole"));
}

TEST_F(LoadLayerTest, WarnsOfAGeoJsonWhoseReferenceSystemIsUnknown) {
  const std::string path = folder_.write(
      "a.geojson",
      R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"EPSG:102100"}},)"
      R"("features":[{"type":"Feature","properties":{},"geometry":{"type":"Polygon",)"
      R"("coordinates":[[[0,0],[1,0],[1,1],[0,0]]]}}]})");
  const LoadReport report = load_layer(path).report;
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_THAT(report.warnings[0], HasSubstr("crs not found"));
}

TEST_F(LoadLayerTest, KeepsAttributesOfAllTypesAndIds) {
  const LoadedLayer loaded = load_layer(kMixed);
  const FeatureTable& table = loaded.layer->features();
  ASSERT_EQ(table.size(), 5u);
  const auto value = [&table](std::uint32_t row, const char* field) {
    return table.value(row, table.field_index(field));
  };
  EXPECT_EQ(table.id(0), 7);
  EXPECT_EQ(table.id(4), 16);
  EXPECT_EQ(value(0, "name"), Value(std::string_view("square")));
  EXPECT_EQ(value(0, "floors"), Value(std::int64_t{3}));
  EXPECT_EQ(value(0, "height"), Value(9.5));
  EXPECT_EQ(value(0, "built"), Value(std::string_view("2001-02-03")));
  EXPECT_EQ(value(0, "old"), Value(std::int64_t{1}));
  EXPECT_EQ(std::get<std::string_view>(value(0, "tags")), R"([ "a", "b" ])");
  EXPECT_EQ(value(1, "floors"), Value());
  EXPECT_EQ(value(1, "built"), Value());
}

TEST_F(LoadLayerTest, DrawsEvenOddOverAllRings) {
  const LoadedLayer loaded = load_layer(kMixed);
  expect_area(*loaded.layer, 0, rectangle(10, 10, 11, 11));
  const double triangle = area_of(*loaded.layer, 2) / 3;
  EXPECT_NEAR((area_of(*loaded.layer, 1) - triangle) /
                  (rectangle(22, 10, 24, 12) - rectangle(22.5, 10.5, 23.5, 11.5)),
              1, 1e-4);
}

TEST_F(LoadLayerTest, LeavesNothingOnStandardError) {
  testing::internal::CaptureStderr();
  load_layer(kMixed);
  load_layer(kVillage);
  failure_of(folder_.write("broken.geojson", "{\"type\": \"FeatureCollection\", \"fea"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(LoadLayerTest, ReadsAreasOfOpenStreetMapWithTheirHoles) {
  const LoadedLayer loaded = load_layer(kVillage);
  EXPECT_EQ(loaded.report.driver, "OSM");
  EXPECT_EQ(loaded.report.loaded, 2u);
  EXPECT_EQ(loaded.report.other_geometry, 2u);  // lane, bench
  EXPECT_EQ(accounted(loaded.report), loaded.report.features);
  const FeatureTable& table = loaded.layer->features();
  const std::uint32_t house = text(*loaded.layer, 0, "building") == "house" ? 0 : 1;
  EXPECT_EQ(text(*loaded.layer, house, "osm_id"), "201");
  EXPECT_EQ(table.value(house, table.field_index("name")), Value());
  EXPECT_EQ(text(*loaded.layer, 1 - house, "osm_way_id"), "103");
  EXPECT_EQ(text(*loaded.layer, 1 - house, "name"), "Schöpfli");
  expect_area(*loaded.layer, house,
              rectangle(9.000, 47.000, 9.004, 47.004) - rectangle(9.001, 47.001, 9.003, 47.003));
}

TEST_F(LoadLayerTest, ReadsBinaryOpenStreetMapLikeXml) {
  const std::string path = folder_.file("village.osm.pbf");
  if (std::system("command -v osmium >/dev/null") != 0) {
    GTEST_SKIP() << "osmium (package osmium-tool) is not installed";
  }
  ASSERT_EQ(std::system(("osmium cat -o " + path + " " + kVillage).c_str()), 0);
  const LoadedLayer binary = load_layer(path);
  const LoadedLayer xml = load_layer(kVillage);
  EXPECT_EQ(binary.report.loaded, 2u);
  EXPECT_EQ(binary.report.other_geometry, xml.report.other_geometry);
  EXPECT_EQ(texts(*binary.layer, "building"), texts(*xml.layer, "building"));
  EXPECT_EQ(binary.layer->bounds(), xml.layer->bounds());
}

class FormatTest : public LoadLayerTest,
                   public ::testing::WithParamInterface<std::tuple<std::string, std::string>> {};

TEST_P(FormatTest, BringsPolygonsAttributesAndOrderThrough) {
  const auto& [driver, name] = GetParam();
  const std::string path = folder_.file(name);
  write_source(path, driver,
               {{.type = wkbMultiPolygon,
                 .features = {{"MULTIPOLYGON(((10 10,11 10,11 11,10 11,10 10)))", 5, "häuser"},
                              {"MULTIPOLYGON(((20 10,20 12,22 12,22 10,20 10),(20.5 10.5,21.5 "
                               "10.5,21.5 11.5,20.5 11.5,20.5 10.5)),((30 10,30 11,31 11,31 10,30 "
                               "10)))",
                               -6, "two"},
                              {"MULTIPOLYGON(((0 0,0 1,1 1,0 0)))", 7, "three"}}}});
  const LoadedLayer loaded = load_layer(path);
  EXPECT_EQ(loaded.report.driver, driver);
  EXPECT_EQ(loaded.report.features, 3u);
  EXPECT_EQ(loaded.report.loaded, 3u);
  EXPECT_EQ(loaded.report.polygons, 4u);
  EXPECT_EQ(loaded.report.rings, 5u);
  EXPECT_EQ(loaded.report.source_vertices, 24u);
  std::vector<std::string> names = texts(*loaded.layer, "text");
  // A spatial index may use its own order; the rows follow the file.
  std::vector<std::int64_t> numbers;
  const FeatureTable& table = loaded.layer->features();
  for (std::uint32_t row = 0; row < 3; ++row) {
    numbers.push_back(std::get<std::int64_t>(table.value(row, table.field_index("number"))));
    if (numbers.back() == 5) {
      EXPECT_EQ(names[row], "häuser");
      expect_area(*loaded.layer, row, rectangle(10, 10, 11, 11));
    }
    if (numbers.back() == -6) {
      EXPECT_EQ(names[row], "two");
      expect_area(*loaded.layer, row,
                  rectangle(20, 10, 22, 12) - rectangle(20.5, 10.5, 21.5, 11.5) +
                      rectangle(30, 10, 31, 11));
    }
  }
  EXPECT_THAT(numbers, ::testing::UnorderedElementsAre(5, -6, 7));
}

INSTANTIATE_TEST_SUITE_P(AllowedFormats, FormatTest,
                         ::testing::Values(std::make_tuple("FlatGeobuf", "a.fgb"),
                                           std::make_tuple("GPKG", "a.gpkg"),
                                           std::make_tuple("ESRI Shapefile", "a.shp"),
                                           std::make_tuple("GeoJSON", "a.geojson"),
                                           std::make_tuple("GeoJSONSeq", "a.geojsonl"),
                                           std::make_tuple("GML", "a.gml"),
                                           std::make_tuple("SQLite", "a.sqlite"),
                                           std::make_tuple("OpenFileGDB", "a.gdb")),
                         [](const auto& test) {
                           std::string name = std::get<0>(test.param);
                           std::erase(name, ' ');
                           return name;
                         });

// Their rings do not name the polygons to which they belong.
TEST_F(LoadLayerTest, KeepsWhatAShapefileCoversTwiceAroundTheWorld) {
  const std::string path = folder_.file("a.shp");
  // The arm in the north-west lies beyond the antimeridian, and so does the end of the band in the
  // second one.
  write_source(
      path, "ESRI Shapefile",
      {{.type = wkbPolygon,
        .features = {{"POLYGON((-190 -20,-190 60,-182 60,-182 20,175 20,175 -20,-190 -20))"},
                     {"POLYGON((-190 -20,-190 60,-182 60,-182 20,185 20,185 -20,"
                      "-190 -20))"}}}});
  const LoadedLayer loaded = load_layer(path);
  ASSERT_EQ(loaded.report.loaded, 2u);
  const double arm = rectangle(170, 20, 178, 60);
  expect_area(*loaded.layer, 0, rectangle(-180, -20, 180, 20) + arm);
  expect_area(*loaded.layer, 1, rectangle(-180, -20, 180, 20) + arm);
}

TEST_F(LoadLayerTest, ReadsKmlThroughWhicheverDriverKnowsIt) {
  const std::string path = folder_.file("a.kml");
  write_source(path, "KML", {{.features = {{"POLYGON((10 10,11 10,11 11,10 11,10 10))", 5, "a"}}}});
  const LoadedLayer loaded = load_layer(path);
  ASSERT_EQ(loaded.report.loaded, 1u);
  expect_area(*loaded.layer, 0, rectangle(10, 10, 11, 11));
}

TEST_F(LoadLayerTest, ReadsTopoJson) {
  const std::string path = folder_.write(
      "a.json",
      R"({"type":"Topology","arcs":[[[10,10],[11,10],[11,11],[10,11],[10,10]]],"objects":)"
      R"({"a":{"type":"GeometryCollection","geometries":[{"type":"Polygon","arcs":[[0]],)"
      R"("properties":{"name":"x"}}]}}})");
  const LoadedLayer loaded = load_layer(path);
  EXPECT_EQ(loaded.report.driver, "TopoJSON");
  ASSERT_EQ(loaded.report.loaded, 1u);
  expect_area(*loaded.layer, 0, rectangle(10, 10, 11, 11));
}

TEST_F(LoadLayerTest, ReadsAShapefileInAZipArchive) {
  const std::string path = "/vsizip/" + folder_.file("a.zip") + "/a.shp";
  // GDAL writes the files into the archive one after another.
  write_source(
      folder_.file("a.shp"), "ESRI Shapefile",
      {{.type = wkbPolygon, .features = {{"POLYGON((10 10,11 10,11 11,10 11,10 10))", 5}}}});
  VSILFILE* keep_open = VSIFOpenL(("/vsizip/" + folder_.file("a.zip")).c_str(), "wb");
  for (const char* extension : {"shp", "shx", "dbf", "prj"}) {
    std::ifstream in(folder_.file(std::string("a.") + extension), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    VSILFILE* out =
        VSIFOpenL(("/vsizip/" + folder_.file("a.zip") + "/a." + extension).c_str(), "wb");
    ASSERT_NE(out, nullptr);
    VSIFWriteL(bytes.data(), 1, bytes.size(), out);
    VSIFCloseL(out);
  }
  VSIFCloseL(keep_open);
  const LoadedLayer loaded = load_layer(path);
  ASSERT_EQ(loaded.report.loaded, 1u);
  expect_area(*loaded.layer, 0, rectangle(10, 10, 11, 11));
}

TEST_F(LoadLayerTest, ReprojectsAnyReferenceSystem) {
  const std::string path = folder_.file("utm.gpkg");
  write_source(path, "GPKG",
               {{.crs = "EPSG:25832",
                 .features = {{"POLYGON((500000 5500000,501000 5500000,501000 "
                               "5501000,500000 5501000,500000 5500000))"}}}});
  const LoadedLayer loaded = load_layer(path);
  ASSERT_EQ(loaded.report.loaded, 1u);
  // x = 500 km is the meridian of 9 degrees; here a map kilometre is 1 / cos(latitude) long.
  EXPECT_NEAR(loaded.layer->bounds().min_x, grid_from_lonlat({9, 0}).x, 2);
  const double latitude = lonlat_from_grid(0, loaded.layer->bounds().max_y).lat;
  EXPECT_NEAR(latitude, 49.65, 0.02);
  const double side = grid_from_metres(1000, 0).x / std::cos(latitude * std::acos(-1.0) / 180);
  EXPECT_NEAR(area_of(*loaded.layer, 0) / (side * side), 1, 0.01);
}

TEST_F(LoadLayerTest, AssumesDegreesWhereNoReferenceSystemIsGiven) {
  const std::string path = folder_.file("a.fgb");
  write_source(path, "FlatGeobuf", {{.crs = "", .features = {{"POLYGON((1 1,2 1,2 2,1 2,1 1))"}}}});
  const LoadedLayer loaded = load_layer(path);
  expect_area(*loaded.layer, 0, rectangle(1, 1, 2, 2));
  EXPECT_THAT(loaded.report.warnings,
              ElementsAre(HasSubstr("names no coordinate reference system, so its coordinates are "
                                    "assumed to be degrees on WGS 84")));
}

TEST_F(LoadLayerTest, WarnsOfEachLayerThatNamesNoReferenceSystem) {
  const std::vector<TestFeature> one = {{"POLYGON((1 1,2 1,2 2,1 2,1 1))"}};
  const std::string path = folder_.file("a.gpkg");
  write_source(
      path, "GPKG",
      {{.name = "known", .features = one}, {.name = "unknown", .crs = "", .features = one}});
  EXPECT_THAT(load_layer(path, {.selection = {.layer = "known"}}).report.warnings, IsEmpty());
  EXPECT_THAT(load_layer(path).report.warnings,
              ElementsAre(StartsWith("its layer \"unknown\" names no")));
}

TEST_F(LoadLayerTest, WarnsOfAShapefileWhosePrjIsMissingOrNotUnderstood) {
  const std::string path = folder_.file("a.shp");
  write_source(path, "ESRI Shapefile",
               {{.type = wkbPolygon, .features = {{"POLYGON((1 1,2 1,2 2,1 2,1 1))"}}}});
  EXPECT_THAT(load_layer(path).report.warnings, IsEmpty());
  folder_.write("a.prj", "no words of a reference system");
  EXPECT_THAT(load_layer(path).report.warnings,
              ElementsAre(HasSubstr("names no coordinate reference system that is known")));
  std::filesystem::remove(folder_.file("a.prj"));
  EXPECT_THAT(load_layer(path).report.warnings,
              ElementsAre(AllOf(HasSubstr("names no coordinate reference system, so"),
                                HasSubstr("a .prj file beside it"))));
}

TEST_F(LoadLayerTest, FormatsWithAUsualReferenceSystemNeedNotNameIt) {
  folder_.write("a.geojson", R"({"type": "Polygon", "coordinates": [[[1,1],[2,1],[2,2],[1,1]]]})");
  folder_.write("a.topojson",
                R"({"type": "Topology", "objects": {"a": {"type": "GeometryCollection",)"
                R"("geometries": [{"type": "Polygon", "arcs": [[0]]}]}},)"
                R"("arcs": [[[1,1],[2,1],[2,2],[1,1]]]})");
  for (const char* name : {"a.geojson", "a.topojson"}) {
    const LoadReport report = load_layer(folder_.file(name)).report;
    EXPECT_EQ(report.loaded, 1u) << name;
    EXPECT_THAT(report.warnings, IsEmpty()) << name;
  }
}

TEST_F(LoadLayerTest, RefusesNumbersThatAreNoDegreesWithoutReferenceSystem) {
  const std::string path = folder_.file("a.fgb");
  write_source(path, "FlatGeobuf",
               {{.crs = "",
                 .features = {{"POLYGON((1 1,2 1,2 2,1 2,1 1))"},
                              {"POLYGON((1000 1,2000 1,2000 2,1000 1))"}}}});
  for (const unsigned threads : {1u, 4u}) {
    EXPECT_THAT(failure_of(path, {.threads = threads, .progress = {}}),
                AllOf(StartsWith(path + ": "), HasSubstr("names no coordinate reference system"),
                      HasSubstr("-a_srs EPSG:NUMBER")));
  }
  const auto findings = examine_layer(path);
  ASSERT_EQ(findings.size(), 1u) << "its extent tells it before it is read";
  EXPECT_EQ(findings[0].what, failure_of(path));
}

TEST_F(LoadLayerTest, RefusesAReferenceSystemThatLeadsNowhere) {
  const std::string path = folder_.file("a.gpkg");
  write_source(path, "GPKG",
               {{.crs = "LOCAL_CS[\"site plan\",UNIT[\"metre\",1]]",
                 .features = {{"POLYGON((1 1,2 1,2 2,1 2,1 1))"}}}});
  EXPECT_THAT(failure_of(path),
              AllOf(StartsWith(path + ": "),
                    HasSubstr("reference system \"site plan\" cannot be transformed to WGS 84")));
}

TEST_F(LoadLayerTest, SkipsFeaturesWithNumbersThatAreNoneAndSaysWhich) {
  const std::string path = folder_.file("a.gpkg");
  {
    const GDALDatasetUniquePtr dataset = create_source(path, "GPKG");
    const OGRSpatialReference reference = test_reference("EPSG:4326");
    OGRLayer* layer = dataset->CreateLayer("a", const_cast<OGRSpatialReference*>(&reference),
                                           wkbPolygon, nullptr);
    for (int i = 0; i < 3; ++i) {
      const OGRFeatureUniquePtr feature(OGRFeature::CreateFeature(layer->GetLayerDefn()));
      const auto geometry = test_geometry("POLYGON((1 1,2 1,2 2,1 2,1 1))");
      if (i == 1) {
        geometry->toPolygon()->getExteriorRing()->setPoint(
            2, std::numeric_limits<double>::quiet_NaN(), 2);
      }
      feature->SetGeometry(geometry.get());
      feature->SetFID(70 + i);
      ASSERT_EQ(layer->CreateFeature(feature.get()), OGRERR_NONE);
    }
  }
  const LoadedLayer loaded = load_layer(path);
  EXPECT_EQ(loaded.report.loaded, 2u);
  EXPECT_EQ(loaded.report.skipped, 1u);
  ASSERT_EQ(loaded.report.notes.size(), 1u);
  EXPECT_EQ(loaded.report.notes[0].id, 71);
  EXPECT_THAT(loaded.report.notes[0].reason, HasSubstr("not a finite number"));
  EXPECT_EQ(loaded.layer->features().size(), 3u);
}

TEST_F(LoadLayerTest, CountsPolygonsThatLeaveNothingToDrawAsEmpty) {
  const std::string path = folder_.file("a.gpkg");
  write_source(path, "GPKG",
               {{.features = {{"POLYGON EMPTY", 1},
                              {"MULTIPOLYGON EMPTY", 2},
                              {"POLYGON((0 88,1 88,1 89,0 88))", 3},
                              {"POLYGON((0 0,1 0,2 0,0 0))", 4},
                              {"", 5}}}});
  const LoadReport report = load_layer(path).report;
  EXPECT_EQ(report.empty, 4u);
  EXPECT_EQ(report.other_geometry, 1u);
  EXPECT_EQ(accounted(report), 5u);
}

TEST_F(LoadLayerTest, PartsThatAreEqualOrOverlapAreDrawnAsTheirUnionAndItIsSaid) {
  const std::string square = "((0 0,1 0,1 1,0 1,0 0))";
  const std::string beside = "((0.5 0,2 0,2 1,0.5 1,0.5 0))";
  const std::string within = "((0.2 0.2,0.4 0.2,0.4 0.4,0.2 0.4,0.2 0.2))";
  const std::string apart = "((3 0,4 0,4 1,3 1,3 0))";
  const std::string path = folder_.file("parts.fgb");
  write_source(path, "FlatGeobuf",
               {{.features = {{"MULTIPOLYGON(" + square + "," + square + ")", 0},
                              {"MULTIPOLYGON(" + square + "," + beside + ")", 1},
                              {"MULTIPOLYGON(" + square + "," + within + ")", 2},
                              {"MULTIPOLYGON(" + square + "," + apart + ")", 3}}}});
  const LoadedLayer loaded = load_layer(path);
  ASSERT_EQ(loaded.report.loaded, 4u);
  const FeatureTable& table = loaded.layer->features();
  const double unit = rectangle(0, 0, 1, 1);
  for (std::uint32_t row = 0; row < 4; ++row) {
    const auto number = std::get<std::int64_t>(table.value(row, table.field_index("number")));
    const bool is_said = std::ranges::any_of(loaded.report.notes, [&](const FeatureNote& note) {
      return note.id == table.id(row) && note.reason == "united: its parts overlap";
    });
    EXPECT_EQ(is_said, number != 3) << number;
    expect_area(*loaded.layer, row, number == 1 || number == 3 ? 2 * unit : unit);
  }
}

TEST_F(LoadLayerTest, JoinsTheLayersOfASourceByFieldNames) {
  const std::string path = folder_.file("a.gpkg");
  {
    const GDALDatasetUniquePtr dataset = create_source(path, "GPKG");
    OGRSpatialReference wgs84 = test_reference("EPSG:4326");
    OGRSpatialReference mercator = test_reference("EPSG:3857");
    const auto add_layer = [&](const char* name, OGRSpatialReference& reference, OGRFieldType type,
                               const char* wkt) {
      OGRLayer* layer = dataset->CreateLayer(name, &reference, wkbUnknown, nullptr);
      OGRFieldDefn code("code", type);
      OGRFieldDefn own(name, OFTReal);
      layer->CreateField(&code);
      layer->CreateField(&own);
      const OGRFeatureUniquePtr feature(OGRFeature::CreateFeature(layer->GetLayerDefn()));
      feature->SetField("code", 12);
      feature->SetField(name, 0.1);
      feature->SetGeometry(test_geometry(wkt).get());
      ASSERT_EQ(layer->CreateFeature(feature.get()), OGRERR_NONE);
    };
    add_layer("one", wgs84, OFTInteger, "POLYGON((10 10,11 10,11 11,10 11,10 10))");
    add_layer("two", mercator, OFTString, "POLYGON((0 0,1000 0,1000 1000,0 1000,0 0))");
    OGRLayer* points = dataset->CreateLayer("points", &wgs84, wkbPoint, nullptr);
    const OGRFeatureUniquePtr point(OGRFeature::CreateFeature(points->GetLayerDefn()));
    point->SetGeometry(test_geometry("POINT(1 1)").get());
    ASSERT_EQ(points->CreateFeature(point.get()), OGRERR_NONE);
  }
  const LoadedLayer loaded = load_layer(path);
  EXPECT_EQ(loaded.report.features, 3u);
  EXPECT_EQ(loaded.report.loaded, 2u);
  EXPECT_EQ(loaded.report.other_geometry, 1u);
  const FeatureTable& table = loaded.layer->features();
  ASSERT_EQ(table.fields().size(), 3u);
  EXPECT_THAT(texts(*loaded.layer, "code"), ElementsAre("12", "12"));
  EXPECT_EQ(table.value(0, table.field_index("one")), Value(0.1));
  EXPECT_EQ(table.value(0, table.field_index("two")), Value());
  EXPECT_EQ(table.value(1, table.field_index("two")), Value(0.1));
  expect_area(*loaded.layer, 0, rectangle(10, 10, 11, 11));
  EXPECT_NEAR(std::sqrt(area_of(*loaded.layer, 1)), grid_from_metres(1000, 0).x, 1);
}

TEST_F(LoadLayerTest, TakesTextThatIsNoUtf8ForLatin1) {
  const std::string path =
      folder_.write("a.geojson",
                    "{\"type\":\"Feature\",\"properties\":{\"name\":\"M\xfcll\"},"
                    "\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
                    "[[[0,0],[1,0],[1,1],[0,0]]]}}");
  EXPECT_EQ(text(*load_layer(path).layer, 0, "name"), "Müll");
}

TEST_F(LoadLayerTest, CutsTextThatEndsWithinACharacter) {
  const auto name_of = [this](const std::string& name) {
    const std::string path =
        folder_.write("a.geojson", "{\"type\":\"Feature\",\"properties\":{\"name\":\"" + name +
                                       "\"},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
                                       "[[[0,0],[1,0],[1,1],[0,0]]]}}");
    return text(*load_layer(path).layer, 0, "name");
  };
  EXPECT_EQ(name_of("Fläche m\xc2"), "Fläche m");
  EXPECT_EQ(name_of("地块编\xe5"), "地块编");
  EXPECT_EQ(name_of("地块编\xe5\x8f"), "地块编");
  EXPECT_EQ(name_of("caf\xe9"), "café");
  EXPECT_EQ(name_of("b\xe9"
                    "b\xe9"),
            "bébé");
}

TEST_F(LoadLayerTest, SaysThatASourceBreaksOff) {
  const std::string path = folder_.file("a.fgb");
  TestLayer layer;
  for (int i = 0; i < 2000; ++i) {
    const std::string x = std::to_string(i % 100);
    layer.features.push_back({"POLYGON((" + x + " 0," + x + " 1,-1 1," + x + " 0))", i, "text"});
  }
  write_source(path, "FlatGeobuf", {layer});
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 4 * 3);
  for (const unsigned threads : {1u, 4u}) {
    EXPECT_THAT(failure_of(path, {.threads = threads, .progress = {}}),
                AllOf(StartsWith(path + ": "), HasSubstr("breaks off after ")));
  }
}

TEST_F(LoadLayerTest, GivesTheSameLayerWhateverTheNumberOfThreads) {
  const std::string path = folder_.file("a.fgb");
  TestLayer layer;
  for (int i = 0; i < 20'000; ++i) {
    const double x = (i % 200) * 0.01;
    const double y = (i / 200) * 0.01;
    const auto at = [&](double dx, double dy) {
      return std::to_string(x + dx) + " " + std::to_string(y + dy);
    };
    // Every tenth one crosses itself.
    layer.features.push_back({"POLYGON((" + at(0, 0) + "," +
                                  (i % 10 == 0 ? at(.005, .005) + "," + at(.005, 0)
                                               : at(.005, 0) + "," + at(.005, .005)) +
                                  "," + at(0, .005) + "," + at(0, 0) + "))",
                              i, "number " + std::to_string(i)});
  }
  write_source(path, "FlatGeobuf", {layer});
  const LoadedLayer one = load_layer(path, {.threads = 1, .progress = {}});
  const LoadedLayer four = load_layer(path, {.threads = 4, .progress = {}});
  EXPECT_EQ(one.report.loaded, 20'000u);
  EXPECT_EQ(four.report.loaded, 20'000u);
  EXPECT_EQ(one.report.repaired, 2'000u);
  EXPECT_EQ(four.report.repaired, 2'000u);
  ASSERT_EQ(one.report.notes.size(), 100u);
  ASSERT_EQ(four.report.notes.size(), 100u);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(one.report.notes[i].id, four.report.notes[i].id);
  }
  EXPECT_EQ(texts(*one.layer, "text"), texts(*four.layer, "text"));
  const MeshView& a = one.layer->mesh();
  const MeshView& b = four.layer->mesh();
  EXPECT_TRUE(std::ranges::equal(a.vertices, b.vertices));
  EXPECT_TRUE(std::ranges::equal(a.edges, b.edges));
  EXPECT_TRUE(std::ranges::equal(a.trapezoids, b.trapezoids));
}

/// Squares in separate columns of ten. In each column, neighbours share halves of their sides, the
/// fourth square overlaps the fifth a little, and a small one overlaps the eighth.
TestLayer columns_of_squares(int columns) {
  TestLayer layer;
  const auto square = [&](double x, double y, double height, double right_height, int number) {
    const auto at = [](double px, double py) {
      return std::to_string(px) + " " + std::to_string(py);
    };
    layer.features.push_back({"POLYGON((" + at(x, y) + "," + at(x + .005, y) + "," +
                                  at(x + .01, y) + "," + at(x + .01, y + right_height) + "," +
                                  at(x + .005, y + height) + "," + at(x, y + height) + "," +
                                  at(x, y) + "))",
                              number, std::to_string(number)});
  };
  for (int x = 0; x < columns; ++x) {
    for (int y = 0; y < 10; ++y) {
      square(x * .02, y * .01, .01, y == 3 ? .01005 : .01, 100 * x + y);
    }
    square(x * .02, .07, .005, .005, 100 * x + 50);
  }
  return layer;
}

TEST_F(LoadLayerTest, TooManyOverEachOtherAreBuiltApartAndItIsSaid) {
  auto layer = columns_of_squares(1);
  layer.features.resize(1);
  while (layer.features.size() < 6000) layer.features.push_back(layer.features.front());
  const std::string path = folder_.file("heap.geojson");
  write_source(path, "GeoJSON", {layer});
  LoadOptions options;
  options.generalization.coverage = CoverageMode::on;
  const LoadReport report = load_layer(path, options).report;
  EXPECT_EQ(report.loaded, 6000u);
  EXPECT_EQ(report.coverage.apart, 6000u);
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_EQ(report.notes[0].reason, "built apart from 5999 neighbours: too many of them overlap");
}

TEST_F(LoadLayerTest, NeighboursAreBuiltTogetherWhateverTheThreads) {
  const std::string path = folder_.file("columns.gpkg");
  write_source(path, "GPKG", {columns_of_squares(40)});
  LoadOptions options{.threads = 1, .progress = {}};
  options.generalization.coverage = CoverageMode::automatic;
  const LoadedLayer one = load_layer(path, options);
  options.threads = 4;
  const LoadedLayer four = load_layer(path, options);
  for (const LoadReport* report : {&one.report, &four.report}) {
    EXPECT_EQ(report->loaded, 440u);
    EXPECT_EQ(report->coverage.groups, 40u);
    EXPECT_EQ(report->coverage.features, 400u);
    EXPECT_EQ(report->coverage.apart, 40u);
    EXPECT_EQ(report->coverage.overlaps, 40u);
    ASSERT_EQ(report->notes.size(), 40u);
    EXPECT_THAT(report->notes[0].reason, HasSubstr("% of it lies under feature"));
  }
  const MeshView& a = one.layer->mesh();
  const MeshView& b = four.layer->mesh();
  EXPECT_TRUE(std::ranges::equal(a.vertices, b.vertices));
  EXPECT_TRUE(std::ranges::equal(a.edges, b.edges));
  EXPECT_TRUE(std::ranges::equal(a.trapezoids, b.trapezoids));
  // Groups are detected by default; with CoverageMode::off there are none.
  EXPECT_EQ(load_layer(path).report.coverage.groups, 40u);
  options.generalization.coverage = CoverageMode::off;
  EXPECT_EQ(load_layer(path, options).report.coverage.groups, 0u);
}

TEST_F(LoadLayerTest, NeighboursAreBroughtTogetherUpToADistance) {
  const std::string path = folder_.file("columns.gpkg");
  write_source(path, "GPKG", {columns_of_squares(4)});
  LoadOptions options;
  options.generalization.coverage = CoverageMode::automatic;
  options.generalization.close_gaps = 4;  // overlaps are five and a half metres wide
  EXPECT_EQ(load_layer(path, options).report.coverage.overlaps, 4u);
  options.generalization.close_gaps = 8;
  const CoverageCounts closed = load_layer(path, options).report.coverage;
  EXPECT_EQ(closed.overlaps, 0u);
  EXPECT_EQ(closed.gaps, 0u);
  EXPECT_GE(closed.snapped, 4u);
  EXPECT_EQ(closed.groups, 4u);
  EXPECT_EQ(closed.features, 40u);
}

//   _____             The corner moves to that of the square, but no border is shared: the triangle
//  |     |\           stays as drawn.
//  |_____| \.
TEST_F(LoadLayerTest, WhatSharesNoBorderAfterGapsAreClosedIsAsItWasDrawn) {
  const std::string path = folder_.file("corner.fgb");
  const std::string square = "POLYGON((0 0,0.01 0,0.01 0.01,0 0.01,0 0))";
  const std::string triangle = "POLYGON((0.01005 0.01,0.02 0.02,0.03 0.01,0.01005 0.01))";
  write_source(path, "FlatGeobuf", {{.features = {{square, 0, ""}, {triangle, 1, ""}}}});
  const auto outlines = [&](CoverageMode coverage, double close_gaps) {
    LoadOptions options;
    options.generalization.coverage = coverage;
    options.generalization.close_gaps = close_gaps;
    const LoadedLayer loaded = load_layer(path, options);
    EXPECT_EQ(loaded.report.coverage.snapped, close_gaps > 0 ? 1u : 0u);
    Rings rings;
    for (const std::uint32_t row : {0, 1}) loaded.layer->append_outline(row, rings);
    return rings;
  };
  EXPECT_EQ(outlines(CoverageMode::automatic, 20), outlines(CoverageMode::off, 0));
}

TEST_F(LoadLayerTest, WhoseGapsAreNotClosedIsSaidInOneNote) {
  const std::string path = folder_.file("small.fgb");
  TestLayer layer;
  for (const std::string x : {"0.0", "0.1", "0.2"}) {
    const std::string row =
        "POLYGON((" + x + "000 0," + x + "001 0," + x + "001 1," + x + "000 0))";
    layer.features.push_back({row, 0, ""});
  }
  write_source(path, "FlatGeobuf", {layer});
  LoadOptions options;
  options.generalization.coverage = CoverageMode::automatic;
  options.generalization.close_gaps = 100;
  const LoadReport report = load_layer(path, options).report;
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_EQ(report.notes[0].reason,
            "its gaps are not closed, nor those of 2 other features: narrower than the distance");
}

TEST_F(LoadLayerTest, ReportsProgressThatRisesToOne) {
  const std::string path = folder_.file("a.fgb");
  TestLayer layer;
  for (int i = 0; i < 6'000; ++i) layer.features.push_back({"POLYGON((0 0,1 0,1 1,0 0))", i, ""});
  write_source(path, "FlatGeobuf", {layer});
  std::vector<double> shares;
  load_layer(path,
             {.threads = 2, .progress = [&shares](double share) { shares.push_back(share); }});
  ASSERT_GE(shares.size(), 3u);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GT(shares.front(), 0);
  EXPECT_EQ(shares.back(), 1);
}

/// A comb whose graph takes a while to build.
std::string comb_of_teeth(int teeth) {
  std::string ring = "0 -1";
  for (int i = 0; i <= teeth; ++i) {
    const double height = i % 2 == 0 ? 0 : (i * 7919 % 1000) * 1e-3;
    ring += "," + std::to_string(i * 1e-4) + " " + std::to_string(height);
  }
  return "POLYGON((" + ring + "," + std::to_string(teeth * 1e-4) + " -1,0 -1))";
}

TEST_F(LoadLayerTest, ProgressCountsTheBuildingOfASingleLargePolygon) {
  const std::string path = folder_.file("comb.fgb");
  write_source(path, "FlatGeobuf", {{.features = {{comb_of_teeth(150'000), 1, ""}}}});
  for (const CoverageMode coverage : {CoverageMode::off, CoverageMode::on}) {
    std::vector<double> shares;
    LoadOptions options{.threads = 2,
                        .progress = [&shares](double share) { shares.push_back(share); }};
    options.generalization.coverage = coverage;
    load_layer(path, options);
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
    EXPECT_LT(shares.front(), .4) << "all has been read then";
    EXPECT_TRUE(std::ranges::any_of(
        shares, [&shares](double s) { return shares.front() + .02 < s && s < 1; }));
    EXPECT_EQ(shares.back(), 1);
  }
}

TEST_F(LoadLayerTest, PassesOnWhatProgressThrows) {
  struct Stop {};
  for (const unsigned threads : {1u, 4u}) {
    EXPECT_THROW(load_layer(kMixed, {.threads = threads, .progress = [](double) { throw Stop(); }}),
                 Stop);
  }
}

TEST_F(LoadLayerTest, LoadsASourceWithoutPolygonsAsAnEmptyLayer) {
  const std::string path = folder_.file("a.geojson");
  write_source(path, "GeoJSON", {{.features = {{"POINT(1 1)"}, {"LINESTRING(0 0,1 1)"}}}});
  const LoadedLayer loaded = load_layer(path);
  EXPECT_EQ(loaded.report.features, 2u);
  EXPECT_EQ(loaded.report.other_geometry, 2u);
  EXPECT_EQ(loaded.layer->features().size(), 0u);
  EXPECT_TRUE(loaded.layer->bounds().is_empty());
}

TEST(LoadLayer, ASingleFeatureIsMergedAsAmongOthers) {
  const TemporaryFolder folder;
  // Two houses, 11 m apart, and a courtyard.
  const TestFeature town{
      "MULTIPOLYGON(((0 0,.001 0,.001 .001,0 .001,0 0),(.0004 .0004,.0004 .0005,.0005 .0005,.0005 "
      ".0004,.0004 .0004)),((.0011 0,.0021 0,.0021 .001,.0011 .001,.0011 0)))",
      1, "town"};
  const TestFeature far{"POLYGON((50 20,50.001 20,50.001 20.001,50 20.001,50 20))", 2, "far"};
  write_source(folder.file("alone.gpkg"), "GPKG", {{.features = {town}}});
  write_source(folder.file("both.gpkg"), "GPKG", {{.features = {town, far}}});
  LoadOptions options;
  options.generalization.merge = 16;
  const LoadedLayer alone = load_layer(folder.file("alone.gpkg"), options);
  const LoadedLayer both = load_layer(folder.file("both.gpkg"), options);
  const double whole = rectangle(0, 0, 0.0021, 0.001);
  for (const Level level : {Level{0}, Level{16}}) {
    EXPECT_EQ(area_of(*alone.layer, 0, level), area_of(*both.layer, 0, level));
  }
  EXPECT_NEAR(area_of(*alone.layer, 0, Level{16}), whole, whole / 100);
}

}  // namespace
}  // namespace trapeze
