#include "core/layer/features_at.h"

#include <gmock/gmock.h>

#include <random>

#include "tests/core/shapes/layers.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// By the parity of the edges to the east, without trapezoids.
bool is_inside(Point p, const Rings& rings) {
  bool inside = false;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const auto ring = rings[r];
    for (std::size_t i = 0; i < ring.size(); ++i) {
      Point a = ring[i];
      Point b = ring[(i + 1) % ring.size()];
      if (a.y > b.y) std::swap(a, b);
      if (a.y <= p.y && p.y < b.y && orientation(a, b, p) > 0) inside = !inside;
    }
  }
  return inside;
}

TEST(FeaturesAtTest, FindsAtFullDetailJustTheFeaturesWhoseBoundariesGoAroundThePoint) {
  for (unsigned seed = 0; seed < 70; ++seed) {
    const auto layer = layer_of({random_shape(seed), random_shape(seed + 7)});
    std::vector<Rings> outlines(2);
    for (std::uint32_t row = 0; row < 2; ++row) layer->append_outline(row, outlines[row]);
    const Box& box = layer->bounds();
    std::mt19937 random(seed);
    std::vector<Point> points = outlines[0].points;  // corners are the hardest cases
    for (int i = 0; i < 200; ++i) {
      points.push_back({std::uniform_int_distribution(box.min_x - 1, box.max_x + 1)(random),
                        std::uniform_int_distribution(box.min_y - 1, box.max_y + 1)(random)});
    }
    for (const Point p : points) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t row = 0; row < 2; ++row) {
        if (is_inside(p, outlines[row])) expected.push_back(row);
      }
      ASSERT_EQ(features_at(*layer, p, 0), expected) << "seed " << seed << " " << p.x << " " << p.y;
    }
  }
}

TEST(FeaturesAtTest, APointOnACommonBorderLiesInOneOfTheNeighbours) {
  const auto layer = layer_of({square(0, 0, 10), square(10, 0, 10), square(0, 10, 10)});
  EXPECT_THAT(features_at(*layer, {10, 5}, 0), ElementsAre(1));
  EXPECT_THAT(features_at(*layer, {5, 10}, 0), ElementsAre(2));
  EXPECT_THAT(features_at(*layer, {0, 0}, 0), ElementsAre(0));
  EXPECT_THAT(features_at(*layer, {20, 5}, 0), IsEmpty());
}

TEST(FeaturesAtTest, FollowsTheBoundaryAsItIsSimplified) {
  Rings notched = square(0, 0, 100000);
  notched.points.insert(notched.points.begin() + 1, {{40000, 0}, {50000, 900}, {60000, 0}});
  notched.ends.back() += 3;
  const auto layer = layer_of({notched});
  const Point in_notch{50000, 500};
  EXPECT_THAT(features_at(*layer, in_notch, nearest_level(100)), IsEmpty());
  EXPECT_THAT(features_at(*layer, in_notch, nearest_level(2000)), ElementsAre(0));
}

TEST(FeaturesAtTest, WhatHasBecomeDustHoldsNothing) {
  const auto layer = layer_of({square(0, 0, 10)});
  EXPECT_THAT(features_at(*layer, {5, 5}, nearest_level(1)), ElementsAre(0));
  EXPECT_THAT(features_at(*layer, {5, 5}, nearest_level(1000)), IsEmpty());
}

TEST(FeaturesAtTest, TheEdgesOfTheWorldCanBeAsked) {
  const auto layer = layer_of({square(kGridMin, kGridMin, kGridMax)});
  EXPECT_THAT(features_at(*layer, {kGridMin, kGridMin}, 0), ElementsAre(0));
  EXPECT_THAT(features_at(*layer, {kGridMax, kGridMax}, 0), IsEmpty());
}

}  // namespace
}  // namespace trapeze
