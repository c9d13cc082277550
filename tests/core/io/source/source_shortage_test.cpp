#include "core/io/source/source_shortage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/io/load/load_layer.h"
#include "tests/core/io/source/written_source.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr int kFeatures = 60;

std::vector<TestFeature> squares() {
  std::vector<TestFeature> features;
  for (int i = 0; i < kFeatures; ++i) {
    const std::string x = std::to_string(i * 0.5);
    const std::string right = std::to_string(i * 0.5 + 0.25);
    features.push_back(
        {"POLYGON((" + x + " 0," + x + " 1," + right + " 1," + right + " 0," + x + " 0))", i,
         "of a street with a long name"});
  }
  return features;
}

class SourceShortageTest : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& driver) const {
    const std::string path = folder_.file(name);
    write_source(path, driver, {{.type = wkbPolygon, .features = squares()}});
    return path;
  }

  static std::string failure_of(const std::string& path, const std::string& where = {}) {
    try {
      LoadOptions options;
      options.selection.where = where;
      load_layer(path, options);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "was loaded";
  }

  static std::uintmax_t size_of(const std::string& path) {
    return std::filesystem::file_size(path);
  }
  static void cut(const std::string& path, std::uintmax_t bytes) {
    std::filesystem::resize_file(path, bytes);
  }

  TemporaryFolder folder_;
};

/// The offsets where the features of a FlatGeobuf begin, and the end of the first feature, from its
/// own sizes.
std::vector<std::uintmax_t> first_features(const std::string& path, std::size_t features) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  const auto size_at = [&bytes](std::uintmax_t at) {
    std::uint32_t size = 0;
    for (int i = 3; i >= 0; --i) size = size << 8 | static_cast<std::uint8_t>(bytes[at + i]);
    return size;
  };
  std::uintmax_t nodes = 0;
  for (std::uintmax_t level = kFeatures; level > 1; level = (level + 15) / 16) nodes += level;
  constexpr std::uintmax_t kMagic = 8;
  constexpr std::uintmax_t kNode = 40;
  std::vector<std::uintmax_t> ends = {kMagic + 4 + size_at(kMagic) + (nodes + 1) * kNode};
  for (std::size_t i = 0; i < features; ++i) ends.push_back(ends.back() + 4 + size_at(ends.back()));
  return ends;
}

TEST_F(SourceShortageTest, AFlatGeobufThatIsCutOffWithinItsIndexIsNotAnEmptyLayer) {
  const std::string path = write("a.fgb", "FlatGeobuf");
  ASSERT_EQ(failure_of(path), "was loaded");
  cut(path, 1500);
  EXPECT_THAT(failure_of(path), AllOf(StartsWith(path), HasSubstr("0 of the 60 features")));
}

TEST_F(SourceShortageTest, AFlatGeobufThatEndsBetweenTwoFeaturesIsNotASmallerLayer) {
  const std::string path = write("a.fgb", "FlatGeobuf");
  const auto ends = first_features(path, 7);
  cut(path, ends[7]);
  EXPECT_THAT(failure_of(path), AllOf(StartsWith(path), HasSubstr("7 of the 60 features")));
  // A condition selects fewer features, but all existing ones are counted.
  EXPECT_THAT(failure_of(path, "number > 3"), HasSubstr("7 of the 60 features"));
}

TEST_F(SourceShortageTest, AConditionThatLetsFewThroughIsNoShortage) {
  for (const auto& [name, driver] : {std::pair("a.fgb", "FlatGeobuf"),
                                     {"a.gpkg", "GPKG"},
                                     {"a.shp", "ESRI Shapefile"},
                                     {"a.sqlite", "SQLite"}}) {
    const std::string path = write(name, driver);
    LoadOptions options;
    options.selection.where = "number > 3";
    EXPECT_EQ(load_layer(path, options).report.loaded, 56u) << name;
    options.selection.where = "number < 0";
    EXPECT_EQ(load_layer(path, options).report.loaded, 0u) << name;
  }
}

TEST_F(SourceShortageTest, AShapefileIsRefusedIfShapesOrRowsAreMissing) {
  const std::string path = write("a.shp", "ESRI Shapefile");
  const std::string table = folder_.file("a.dbf");
  const std::uintmax_t whole = size_of(path);
  const std::uintmax_t whole_table = size_of(table);
  constexpr std::uintmax_t kShape = 136;  // of five points
  for (const std::uintmax_t missing : {std::uintmax_t{1}, kShape}) {
    cut(path, whole - missing);
    EXPECT_THAT(failure_of(path), AllOf(StartsWith(path), HasSubstr(".shp is cut off"),
                                        HasSubstr("59 of its 60 shapes")));
    write("a.shp", "ESRI Shapefile");
  }
  cut(table, whole_table / 2);
  EXPECT_THAT(failure_of(path),
              AllOf(StartsWith(path), HasSubstr(".dbf is cut off"), HasSubstr("of its 60 rows")));
  for (const std::uintmax_t left : {20, 50}) {
    cut(table, left);
    EXPECT_THAT(failure_of(path), HasSubstr("within the header"));
  }
}

TEST_F(SourceShortageTest, AShapefileOfFilesFromTwoStatesIsRefused) {
  const std::string path = write("a.shp", "ESRI Shapefile");
  const std::string other = folder_.file("b.shp");
  write_source(other, "ESRI Shapefile", {{.type = wkbPolygon, .features = {squares().front()}}});
  std::filesystem::copy_file(folder_.file("b.dbf"), folder_.file("a.dbf"),
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(failure_of(path), AllOf(HasSubstr("60 shapes"), HasSubstr("1 rows")));
}

TEST_F(SourceShortageTest, AShapefileWithoutATableOrWithDeletedRowsIsWhole) {
  const std::string path = write("a.shp", "ESRI Shapefile");
  {
    const GDALDatasetUniquePtr dataset(
        GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE));
    ASSERT_EQ(dataset->GetLayer(0)->DeleteFeature(3), OGRERR_NONE);
  }
  EXPECT_EQ(load_layer(path).report.loaded, 59u);
  std::filesystem::remove(folder_.file("a.dbf"));
  EXPECT_EQ(failure_of(path), "was loaded");
}

TEST_F(SourceShortageTest, ADatabaseThatLacksAPartOfItsLastPageIsRefused) {
  for (const auto& [name, driver] : {std::pair("a.gpkg", "GPKG"), {"a.sqlite", "SQLite"}}) {
    const std::string path = write(name, driver);
    cut(path, size_of(path) - 200);
    // The end of a GeoPackage holds its schema, which is immediately rejected as malformed.
    EXPECT_THAT(failure_of(path), AllOf(StartsWith(path), AnyOf(HasSubstr("lacks 200 of its 4096"),
                                                                HasSubstr("malformed"))));
    cut(path, size_of(path) / 4096 * 4096);
    EXPECT_THAT(failure_of(path), HasSubstr("malformed"));
  }
}

TEST_F(SourceShortageTest, FeaturesThatFollowASingleOneAreNotPassedOver) {
  const std::string square =
      R"({"type":"Feature","properties":{"a":"}\\\""},)"
      R"("geometry":{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1],[0,0]]]}})";
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(failure_of(folder_.write("one.geojson", mark + square + "\r\n\n")), "was loaded");
  EXPECT_EQ(failure_of(folder_.write("lines.geojsonl", square + "\n" + square + "\n")),
            "was loaded");
  for (const std::string& text : {mark + square + "\n" + square, square + square}) {
    EXPECT_THAT(failure_of(folder_.write("a.geojsonl", text)), HasSubstr("only its first feature"));
  }
}

TEST_F(SourceShortageTest, TextThatIsCutOffIsRefused) {
  for (const auto& [name, driver] :
       {std::pair("a.geojson", "GeoJSON"), {"a.geojsonl", "GeoJSONSeq"}, {"a.gml", "GML"}}) {
    const std::string path = write(name, driver);
    cut(path, size_of(path) - 20);
    EXPECT_THAT(failure_of(path), StartsWith(path));
  }
  const std::string path = folder_.file("village.osm");
  std::filesystem::copy_file(TRAPEZE_FIXTURES "/village.osm", path);
  cut(path, size_of(path) - 10);
  EXPECT_THAT(failure_of(path), AllOf(StartsWith(path), HasSubstr("breaks off")));
}

}  // namespace
}  // namespace trapeze
