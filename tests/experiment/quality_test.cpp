#include "bench/experiment/quality.h"

#include <gtest/gtest.h>

#include "bench/experiment/trip.h"
#include "tests/core/shapes/ring_text.h"
#include "tests/experiment/sample_map.h"

namespace trapeze::experiment {
namespace {

TEST(Quality, DistanceIsThatOfTheFarthestDroppedVertex) {
  const Rings source = rings_from_text("0 0, 50 -3, 100 0, 104 50, 100 100, 0 100");
  EXPECT_EQ(distance_between(source, rings_from_text("0 0, 100 0, 100 100, 0 100")), 4);
  EXPECT_EQ(distance_between(source, source), 0);
  // The chord that replaced a vertex is not the nearest side.
  const Rings notch = rings_from_text("0 0, 100 0, 100 100, 50 100, 52 1, 48 1, 50 100, 0 100");
  EXPECT_EQ(distance_between(notch, rings_from_text("0 0, 100 0, 100 100, 0 100")), 1);
}

TEST(Quality, DistanceLeavesOutRingsThatHaveGone) {
  const Rings source = rings_from_text("0 0, 100 0, 100 100, 0 100; 50 50, 60 50, 50 60");
  EXPECT_EQ(distance_between(source, rings_from_text("0 0, 100 0, 100 100, 0 100")), 0);
}

TEST(Quality, ValidIsWhatGeosCallsValid) {
  EXPECT_TRUE(is_valid_polygon(rings_from_text("0 0, 10 0, 0 10; 1 1, 3 1, 1 3"), 0, 2));
  EXPECT_FALSE(is_valid_polygon(rings_from_text("0 0, 10 10, 10 0, 0 10"), 0, 1));
  EXPECT_FALSE(is_valid_polygon(rings_from_text("0 0, 10 0, 0 10; 20 20, 23 20, 20 23"), 0, 2));
}

TEST(Quality, OfAMapIsWithinTheToleranceAndValid) {
  const Map map = sample_map(200);
  const ScaledView view = view_around(map, {300000, 400000}, 200000, 1600, 1200, 1);
  for (const Method method : {Method::douglas_peucker, Method::adapting, Method::lifespans}) {
    const auto qualities = measure_quality(method, Topology::strict, map, std::span(&view, 1));
    ASSERT_EQ(qualities.size(), 1u);
    const Quality& quality = qualities.front();
    EXPECT_EQ(quality.polygons, 201u);
    EXPECT_EQ(quality.invalid, 0u);
    EXPECT_GT(quality.gone, 0u);
    EXPECT_LT(quality.gone, 201u);
    EXPECT_GT(quality.hausdorff, 0);
    EXPECT_LE(quality.hausdorff, quality.tolerance);
    EXPECT_GT(quality.area_error, 0);
    EXPECT_LT(quality.area_error, 0.1);
  }
}

}  // namespace
}  // namespace trapeze::experiment
