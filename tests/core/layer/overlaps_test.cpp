#include "core/layer/overlaps.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <set>

#include "core/borders/coverage_builder.h"
#include "core/layer/layer_contents.h"
#include "core/sweep/clean_rings.h"
#include "tests/core/shapes/layers.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

std::unique_ptr<Layer> layer_of_texts(const std::vector<std::string>& texts) {
  std::vector<Rings> polygons;
  for (const std::string& text : texts) polygons.push_back(rings_from_text(text));
  return layer_of(std::move(polygons));
}

Pairs pairs_of(const Layer& layer) {
  Pairs pairs;
  for (const FeatureOverlap& overlap : layer.overlaps().pairs()) {
    pairs.emplace(overlap.row, overlap.other);
  }
  return pairs;
}

auto overlap(std::uint32_t row, std::uint32_t other, const auto& width) {
  return AllOf(::testing::Field(&FeatureOverlap::row, row),
               ::testing::Field(&FeatureOverlap::other, other),
               ::testing::Field(&FeatureOverlap::width, width));
}

TEST(OverlapsTest, NeighboursThatTouchHaveNone) {
  const auto layer = layer_of_texts({"0 0, 100 0, 90 100, 0 100", "100 0, 200 0, 200 100, 90 100",
                                     "0 100, 90 100, 200 100, 200 200, 0 200"});
  EXPECT_TRUE(layer->overlaps().empty());
  EXPECT_THAT(layer->overlaps().of(1), IsEmpty());
}

TEST(OverlapsTest, NeighboursWhoseBorderTheGridMovedHaveNone) {
  // The border of the second feature lacks a vertex of the first, which is a cell away from it.
  const auto layer = layer_of_texts(
      {"0 0, 90000 0, 50000 501, 10000 1000, 0 1000", "90000 0, 90000 1000, 10000 1000"});
  EXPECT_TRUE(layer->overlaps().empty());
}

TEST(OverlapsTest, EitherFeatureKnowsTheOther) {
  const auto layer = layer_of_texts(
      {"0 0, 100 0, 100 100, 0 100", "20 20, 60 20, 60 60, 20 60", "90 0, 300 0, 300 100, 90 100"});
  // A square of 40 cells is 40 x 40 / hypot(40, 40) wide; a strip of 10 x 100 about 10.
  const OverlapTable& overlaps = layer->overlaps();
  EXPECT_THAT(overlaps.of(0), ElementsAre(overlap(0, 1, 28u), overlap(0, 2, 9u)));
  EXPECT_THAT(overlaps.of(1), ElementsAre(overlap(1, 0, 28u)));
  EXPECT_THAT(overlaps.of(2), ElementsAre(overlap(2, 0, 9u)));
}

TEST(OverlapsTest, KnowWhereBoundariesRunAlongEachOther) {
  constexpr std::uint32_t kSide = 10'000;
  const auto along = [](const std::string& other) {
    const auto layer = layer_of_texts({"0 0, 10000 0, 10000 10000, 0 10000", other});
    const auto overlaps = layer->overlaps().of(0);
    EXPECT_EQ(overlaps.size(), 1u) << other;
    EXPECT_EQ(layer->overlaps().runs_along_another(1), overlaps[0].along > 0) << other;
    return overlaps[0].along;
  };
  EXPECT_EQ(along("2000 2000, 6000 2000, 6000 6000, 2000 6000"), 0u);
  EXPECT_EQ(along("5000 -50, 15000 5000, 5000 9000"), 0u);
  EXPECT_EQ(along("0 0, 10000 0, 10000 10000, 0 10000"), 4 * kSide);
  EXPECT_EQ(along("0 -500, 5000 -500, 5000 20000, 0 20000"), kSide);
  EXPECT_EQ(along("2000 0, 6000 0, 6000 500, 2000 500"), 4000u);
  // On the other side of the boundary.
  EXPECT_EQ(along("-500 2000, 10000 1000, 10000 500"), 500u);
}

TEST(OverlapsTest, APolygonInTheHoleOfAnotherHasNone) {
  const auto layer = layer_of_texts(
      {"0 0, 100 0, 100 100, 0 100; 20 20, 80 20, 80 80, 20 80", "20 20, 80 20, 80 80, 20 80"});
  EXPECT_TRUE(layer->overlaps().empty());
}

TEST(OverlapsTest, FeaturesOfOneGraphAreNotCompared) {
  const auto layer = layer_of_texts({"0 0, 100 0, 100 100, 0 100", "20 20, 60 20, 60 60, 20 60"});
  const LayerContents& c = layer->contents();
  const std::vector<std::uint32_t> apart = {0, 1};
  const std::vector<std::uint32_t> together = {5, 5};
  const std::vector<Box> boxes = {{0, 0, 100, 100}, {20, 20, 60, 60}};
  OverlapInput input{layer->mesh(), c.lifespans, c.feature_of, apart, boxes};
  EXPECT_EQ(find_overlaps(input).pairs.size(), 2u);
  input.kinds = together;
  EXPECT_THAT(find_overlaps(input).pairs, IsEmpty());
}

TEST(OverlapsTest, AreThoseOfTheOverlayOfStars) {
  std::size_t found = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    std::vector<Rings> stars;
    for (int i = 0; i < 12; ++i) {
      const auto x = std::uniform_int_distribution<std::int32_t>(-4000, 4000)(random);
      const auto y = std::uniform_int_distribution<std::int32_t>(-4000, 4000)(random);
      stars.emplace_back();
      stars.back().add(random_star(random, {x, y}, 12, 300, 1500));
    }
    std::vector<Rings> clean = stars;
    std::vector<const Rings*> pointers;
    for (Rings& rings : clean) {
      clean_rings(rings);
      pointers.push_back(&rings);
    }
    const auto layer = layer_of(stars);
    const Pairs pairs = pairs_of(*layer);
    Pairs all;
    for (const Overlap& o : overlay(pointers).overlaps) {
      all.emplace(o.lower, o.upper);
      all.emplace(o.upper, o.lower);
      // Certainly wider than two cells somewhere.
      if (o.area < 20'000) continue;
      ++found;
      EXPECT_TRUE(pairs.contains({o.lower, o.upper})) << "seed " << seed << ", area " << o.area;
    }
    for (const auto& pair : pairs) EXPECT_TRUE(all.contains(pair)) << "seed " << seed;
  }
  EXPECT_GT(found, 300u);
}

TEST(OverlapsTest, AreAllOfThoseOfManySquaresOfAllSizes) {
  std::mt19937 random(3);
  struct Square {
    int x, y, side;
  };
  std::vector<Square> squares;
  std::vector<Rings> polygons;
  for (int i = 0; i < 3000; ++i) {
    // Two towns far apart, and a few large features around them.
    const int side = i % 500 == 0 ? 400'000 : 10 + static_cast<int>(random() % 400);
    const int town = i % 2 == 0 ? -1'000'000 : 1'000'000;
    const int x = town + static_cast<int>(random() % 10'000);
    const int y = static_cast<int>(random() % 10'000);
    squares.push_back({x, y, side});
    polygons.push_back(square(x, y, side));
  }
  Pairs expected;
  for (std::uint32_t a = 0; a < squares.size(); ++a) {
    for (std::uint32_t b = 0; b < squares.size(); ++b) {
      const auto common = [](int p, int p_side, int q, int q_side) {
        return std::min(p + p_side, q + q_side) - std::max(p, q);
      };
      const int width = common(squares[a].x, squares[a].side, squares[b].x, squares[b].side);
      const int height = common(squares[a].y, squares[a].side, squares[b].y, squares[b].side);
      if (a != b && width > 0 && height > 0 && width * 1.0 * height > 2 * std::hypot(width, height))
        expected.emplace(a, b);
    }
  }
  EXPECT_GT(expected.size(), 10'000u);
  EXPECT_TRUE(pairs_of(*layer_of(polygons)) == expected);
}

TEST(OverlapsTest, FeaturesThatAllCoverOnePlaceAreAllPairs) {
  const auto layer = layer_of(std::vector<Rings>(200, square(0, 0, 100)));
  EXPECT_EQ(layer->overlaps().pairs().size(), 200u * 199);
}

TEST(OverlapsTest, TooManyAreNotAllKnown) {
  const auto layer = layer_of(std::vector<Rings>(2100, square(0, 0, 100)));
  EXPECT_FALSE(layer->has_all_overlaps());
  EXPECT_FALSE(layer->overlaps().empty());
  EXPECT_TRUE(layer_of(std::vector<Rings>(10, square(0, 0, 100)))->has_all_overlaps());
}

TEST(OverlapTableTest, RefusesPairsThatAreNotInOrderOrNotThere) {
  const auto table = [](std::vector<FeatureOverlap> pairs) { OverlapTable(std::move(pairs), 2); };
  EXPECT_NO_THROW(table({{0, 1, 5}, {1, 0, 5}}));
  EXPECT_THROW(table({{1, 0, 5}, {0, 1, 5}}), std::invalid_argument);
  EXPECT_THROW(table({{0, 2, 5}}), std::invalid_argument);
  EXPECT_THROW(table({{2, 0, 5}}), std::invalid_argument);
}

}  // namespace
}  // namespace trapeze
