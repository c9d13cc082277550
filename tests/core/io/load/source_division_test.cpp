#include "core/io/load/source_division.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/io/load/load_layer.h"
#include "core/layer/layer_contents.h"
#include "tests/core/io/source/written_source.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

/// In metres of EPSG:3857.
struct Square {
  double x = 0;
  double y = 0;
  double side = 0;

  bool meets(const Square& other) const {
    return x <= other.x + other.side && other.x <= x + side && y <= other.y + other.side &&
           other.y <= y + side;
  }
};

std::string wkt_of(const Square& s) {
  const auto corner = [](double x, double y) {
    return std::to_string(x) + " " + std::to_string(y);
  };
  return "POLYGON((" + corner(s.x, s.y) + "," + corner(s.x + s.side, s.y) + "," +
         corner(s.x + s.side, s.y + s.side) + "," + corner(s.x, s.y + s.side) + "," +
         corner(s.x, s.y) + "))";
}

std::string write_squares(const TemporaryFolder& folder, const std::vector<Square>& squares,
                          const std::string& driver = "GPKG") {
  TestLayer layer;
  layer.crs = "EPSG:3857";
  for (const Square& square : squares) layer.features.push_back({wkt_of(square)});
  const std::string path = folder.file(driver == "GPKG" ? "squares.gpkg" : "squares.fgb");
  write_source(path, driver, {layer});
  return path;
}

std::vector<Square> random_squares(std::uint32_t seed, std::size_t count, double most_side) {
  std::mt19937 random(seed);
  std::vector<Square> squares;
  for (std::size_t i = 0; i < count; ++i) {
    const auto next = [&random](double range) {
      return range * static_cast<double>(random() % 100'000) / 1e5;
    };
    squares.push_back({next(100'000), next(100'000), 100 + next(most_side)});
  }
  return squares;
}

std::shared_ptr<const SourceDivision> divide(const std::string& path, std::uint32_t count,
                                             LayerOptions options = {}) {
  return SourceDivision::of(path, {}, options, count, {});
}

std::map<std::int64_t, Box> boxes_by_id(const Layer& layer) {
  std::map<std::int64_t, Box> boxes;
  for (std::size_t i = 0; i < layer.contents().feature_of.size(); ++i) {
    const std::uint32_t row = layer.contents().feature_of[i];
    if (row >= layer.features().size()) continue;
    boxes[layer.features().id(row)].include(box_of(layer.mesh(), layer.mesh().trapezoids[i]));
  }
  return boxes;
}

TEST(SourceDivisionTest, PutsFeaturesWhoseBoxesMeetIntoOnePart) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    const TemporaryFolder folder;
    const auto squares = random_squares(seed, 6000, 1500);
    const auto division = divide(write_squares(folder, squares), 7);
    std::set<std::uint32_t> numbers;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      numbers.insert(division->part_of(i));
      for (std::size_t k = 0; k < i; ++k) {
        if (!squares[i].meets(squares[k])) continue;
        ASSERT_EQ(division->part_of(i), division->part_of(k)) << "seed " << seed;
      }
    }
    EXPECT_THAT(numbers, ::testing::ElementsAre(1, 2, 3, 4, 5, 6, 7)) << "seed " << seed;
  }
}

TEST(SourceDivisionTest, GivesPartsAboutAsManyVertices) {
  const TemporaryFolder folder;
  const auto division = divide(write_squares(folder, random_squares(4, 4000, 10)), 8);
  std::size_t features = 0;
  for (const SourceDivision::Part& part : division->parts()) {
    EXPECT_NEAR(static_cast<double>(part.vertices), 4000 * 4 / 8.0, 200);
    features += part.features;
  }
  EXPECT_EQ(features, 4000u);
}

TEST(SourceDivisionTest, DoesNotDivideWhatHangsTogether) {
  const TemporaryFolder folder;
  std::vector<Square> chain;
  for (int i = 0; i < 50; ++i) chain.push_back({1000.0 * i, 700.0 * i, 1000});
  const auto division = divide(write_squares(folder, chain), 5);
  EXPECT_EQ(division->largest_group(), 50u * 4);
  for (std::size_t i = 1; i < chain.size(); ++i) {
    EXPECT_EQ(division->part_of(i), division->part_of(0));
  }
}

TEST(SourceDivisionTest, KeepsThoseTogetherBetweenWhichGapsAreClosed) {
  const TemporaryFolder folder;
  const std::string path = write_squares(folder, {{0, 0, 100}, {103, 0, 100}, {9000, 0, 100}});
  LayerOptions options;
  EXPECT_EQ(divide(path, 3, options)->largest_group(), 4u);
  options.close_gaps = 4;
  EXPECT_EQ(divide(path, 3, options)->largest_group(), 8u);
}

TEST(SourceDivisionTest, IsKnownByWhatWasDividedAndHow) {
  const TemporaryFolder folder;
  const TemporaryFolder other;
  auto squares = random_squares(5, 100, 10);
  const std::string path = write_squares(folder, squares);
  const auto fingerprint = divide(path, 3)->fingerprint();
  EXPECT_EQ(divide(path, 3)->fingerprint(), fingerprint);
  EXPECT_NE(divide(path, 4)->fingerprint(), fingerprint);
  squares[50].x += 1;
  EXPECT_NE(divide(write_squares(other, squares), 3)->fingerprint(), fingerprint);
}

// For FlatGeobuf, small parts are read by the file offsets of their features.
TEST(SourceDivisionTest, PartsHaveEachFeatureOnceUnderItsId) {
  for (const std::string driver : {"GPKG", "FlatGeobuf"}) {
    for (const std::uint32_t count : {4u, 30u}) {
      SCOPED_TRACE(driver + " in " + std::to_string(count));
      const TemporaryFolder folder;
      const std::string path = write_squares(folder, random_squares(6, 300, 3000), driver);
      const LoadedLayer whole = load_layer(path);
      const auto boxes = boxes_by_id(*whole.layer);
      LoadOptions options;
      options.division = divide(path, count);
      std::multiset<std::int64_t> ids;
      std::size_t vertices = 0;
      std::size_t largest = 0;
      for (options.part = 1; options.part <= count; ++options.part) {
        const LoadedLayer part = load_layer(path, options);
        EXPECT_EQ(part.part->number, options.part);
        EXPECT_EQ(part.part->count, count);
        EXPECT_EQ(part.report.features, options.division->parts()[options.part - 1].features);
        const FeatureTable& features = part.layer->features();
        for (std::uint32_t row = 0; row < features.size(); ++row) {
          ids.insert(features.id(row));
          EXPECT_TRUE(row == 0 || features.id(row - 1) < features.id(row)) << "the source's order";
        }
        for (const auto& [id, box] : boxes_by_id(*part.layer)) EXPECT_EQ(box, boxes.at(id)) << id;
        vertices += part.report.vertices;
        largest = std::max<std::size_t>(largest, features.size());
      }
      EXPECT_EQ(ids.size(), 300u);
      EXPECT_EQ(std::set<std::int64_t>(ids.begin(), ids.end()).size(), 300u);
      EXPECT_EQ(vertices, whole.report.vertices);
      EXPECT_LT(largest, 300u / count * 2);
    }
  }
}

}  // namespace
}  // namespace trapeze
