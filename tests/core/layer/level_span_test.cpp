#include "core/layer/level_span.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "core/layer/class_dust.h"
#include "core/layer/layer_builder.h"
#include "core/mesh/mesh_index.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze {
namespace {

constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();

std::unique_ptr<Layer> shapes() {
  std::vector<LayerBuilder> builders(1);
  FeatureTable features;
  for (unsigned seed = 0; seed < 80; ++seed) {
    Rings rings = random_shape(seed);
    builders[0].add(features.append(seed, {}), rings);
  }
  return LayerBuilder::join(builders, std::move(features));
}

/// Nested boxes, and nested level ranges.
struct Place {
  explicit Place(const Box& bounds, unsigned seed) : random(seed) {
    outer.box = part_of(bounds);
    inner.box = part_of(outer.box);
    outer.dust_box = outer.box;
    inner.dust_box = inner.box;
    outer.has_edges = inner.has_edges = outer.has_motes = inner.has_motes = true;
    outer.levels = outer.resolutions = {2, 40};
    inner.levels = inner.resolutions = {level(2, 20), level(20, 40)};
    outer.births = {0, 40};
    inner.births = {0, level(0, 40)};
  }

  std::int32_t between(std::int32_t from, std::int32_t to) {
    return std::uniform_int_distribution<std::int32_t>(from, to)(random);
  }
  Level level(int from, int to) { return static_cast<Level>(between(from, to)); }
  Box part_of(const Box& box) {
    const std::int32_t west = between(box.min_x, box.max_x);
    const std::int32_t north = between(box.min_y, box.max_y);
    return {west, north, between(west, box.max_x), between(north, box.max_y)};
  }

  std::mt19937 random;
  LevelSpanSelection outer;
  LevelSpanSelection inner;
};

TEST(LevelSpanTest, NarrowingGivesWhatFindingDoes) {
  const auto layer = shapes();
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Place place(layer->bounds(), seed);
    LevelSpan outer;
    LevelSpan narrowed;
    LevelSpan found;
    ASSERT_TRUE(outer.find(*layer, {}, place.outer, kAll));
    ASSERT_TRUE(found.find(*layer, {}, place.inner, kAll));
    narrowed.narrow(*layer, outer, place.inner);
    EXPECT_TRUE(std::ranges::equal(narrowed.polygons(), found.polygons())) << seed;
    EXPECT_TRUE(std::ranges::equal(narrowed.edges(), found.edges())) << seed;
    EXPECT_TRUE(std::ranges::equal(narrowed.motes(), found.motes())) << seed;
    EXPECT_TRUE(std::ranges::equal(narrowed.grains(), found.grains())) << seed;
  }
}

TEST(LevelSpanTest, HasWhateverIsSeenAtAnyOfItsLevels) {
  const auto layer = shapes();
  for (unsigned seed = 0; seed < 50; ++seed) {
    const Place place(layer->bounds(), seed);
    LevelSpan span;
    ASSERT_TRUE(span.find(*layer, {}, place.inner, kAll));
    for (int level = place.inner.levels.finest; level <= place.inner.levels.coarsest; ++level) {
      std::vector<TrapezoidRange> ranges;
      layer->select({place.inner.box, static_cast<Level>(level), kLastLevel, SmallPolygons::drop},
                    ranges);
      for_each_trapezoid(ranges, [&](std::uint32_t i) {
        if (!meets(layer->mesh(), layer->mesh().trapezoids[i], place.inner.box)) return;
        EXPECT_TRUE(std::ranges::binary_search(span.polygons(), i)) << seed << ' ' << level;
      });
    }
  }
}

TEST(LevelSpanTest, LeavesOutFeaturesThatAreNotDrawn) {
  const auto layer = shapes();
  std::vector<std::uint8_t> classes(layer->features().size(), kNotDrawn);
  classes[7] = 0;
  LevelSpanSelection all;
  all.box = all.dust_box = layer->bounds();
  all.has_edges = true;
  all.births = {0, kLastLevel};
  LevelSpan span;
  ASSERT_TRUE(span.find(*layer, classes, all, kAll));
  EXPECT_FALSE(span.polygons().empty());
  for (const std::uint32_t i : span.polygons()) EXPECT_EQ(layer->feature_of(i), 7u);
  for (const FeatureGrain* grain : span.grains()) EXPECT_EQ(grain->row, 7u);
}

TEST(LevelSpanTest, HoldsNothingWhereThereIsTooMuch) {
  const auto layer = shapes();
  LevelSpanSelection all;
  all.box = all.dust_box = layer->bounds();
  LevelSpan span;
  EXPECT_FALSE(span.find(*layer, {}, all, 10));
  EXPECT_TRUE(span.empty());
}

}  // namespace
}  // namespace trapeze
