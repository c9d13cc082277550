#include "core/io/export/list_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <ogrsf_frmts.h>

#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;

std::string polygon(int id, const std::string& ring) {
  return R"({"type":"Feature","id":)" + std::to_string(id) +
         R"(,"properties":{},"geometry":{"type":"Polygon","coordinates":[)" + ring + "]}}";
}

// Features 11 and 12 with a gap of 10 m between them that 13 and 14 close; half of 15 overlaps 14.
std::string parcels() {
  return R"({"type":"FeatureCollection","features":[)" +
         polygon(11, "[[0,0],[0.001,0],[0.001,0.001],[0,0.001],[0,0]]") + "," +
         polygon(12, "[[0.0011,0],[0.002,0],[0.002,0.001],[0.0011,0.001],[0.0011,0]]") + "," +
         polygon(13,
                 "[[0,-0.001],[0.002,-0.001],[0.002,0],[0.0011,0],[0.001,0],[0,0],[0,-0.001]]") +
         "," +
         polygon(14,
                 "[[0,0.001],[0.001,0.001],[0.0011,0.001],[0.002,0.001],[0.002,0.002],[0,0.002],[0,"
                 "0.001]]") +
         "," +
         polygon(15,
                 "[[0.0005,0.0015],[0.001,0.0015],[0.001,0.0025],[0.0005,0.0025],[0.0005,0."
                 "0015]]") +
         "]}";
}

std::string contents_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> rows_of(const std::string& path) {
  const GDALDatasetUniquePtr dataset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  if (dataset == nullptr) throw std::runtime_error("cannot open " + path);
  std::vector<std::string> rows;
  for (const auto& feature : *dataset->GetLayer(0)) {
    EXPECT_TRUE(feature->GetGeometryRef()->IsValid());
    rows.push_back(std::string(feature->GetFieldAsString("kind")) + " of " +
                   feature->GetFieldAsString("features") + ", " +
                   std::to_string(std::lround(feature->GetFieldAsDouble("area"))) + " m2, " +
                   std::to_string(std::lround(feature->GetFieldAsDouble("width"))) + " m");
  }
  return rows;
}

TEST(ListFaults, EveryPlaceIsAFeatureWithItsFigures) {
  const TemporaryFolder folder;
  const std::string source = folder.write("parcels.geojson", parcels());
  for (const char* name : {"out.geojson", "out.gpkg", "out.fgb"}) {
    const FaultReport report = list_faults(source, folder.file(name));
    EXPECT_EQ(report.gaps, 1u);
    EXPECT_EQ(report.overlaps, 1u);
    EXPECT_THAT(report.notes, ::testing::IsEmpty());
    // Strips of 11.1 by 111.3 m and of 55.7 by 55.7 m, on the sphere.
    EXPECT_THAT(rows_of(folder.file(name)),
                ::testing::UnorderedElementsAre("gap of 11,12,13,14, 1240 m2, 10 m",
                                                "overlap of 14,15, 3097 m2, 28 m"));
  }
}

TEST(ListFaults, DoesNotDependOnTheNumberOfThreads) {
  const TemporaryFolder folder;
  std::string features;
  for (int i = 0; i < 60; ++i) {
    const std::string west = std::to_string(0.01 * (i / 3) + 0.001 * (i % 3));
    const std::string east = std::to_string(0.01 * (i / 3) + 0.001 * (i % 3) + 0.0015);
    features +=
        (i == 0 ? "" : ",") + polygon(i, "[[" + west + ",0],[" + east + ",0],[" + east +
                                             ",0.001],[" + west + ",0.001],[" + west + ",0]]");
  }
  const std::string source =
      folder.write("rows.geojson", R"({"type":"FeatureCollection","features":[)" + features + "]}");
  FaultOptions options;
  options.threads = 1;
  EXPECT_EQ(list_faults(source, folder.file("one.geojson"), options).overlaps, 40u);
  options.threads = 4;
  options.overwrite = true;
  list_faults(source, folder.file("out.geojson"), options);
  const std::string first = contents_of(folder.file("one.geojson"));
  std::string other = contents_of(folder.file("out.geojson"));
  other.replace(other.find("\"out\""), 5, "\"one\"");
  EXPECT_EQ(other, first);
}

TEST(ListFaults, OutputsThatAreThereStay) {
  const TemporaryFolder folder;
  const std::string source = folder.write("parcels.geojson", parcels());
  const std::string output = folder.write("out.geojson", "mine");
  try {
    list_faults(source, output);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("out.geojson: cannot be written: it exists already"));
  }
  EXPECT_EQ(contents_of(output), "mine");
}

}  // namespace
}  // namespace trapeze
