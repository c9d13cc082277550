#include "bench/experiment/trip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/experiment/figures.h"
#include "tests/experiment/sample_map.h"

namespace trapeze::experiment {
namespace {

using ::testing::SizeIs;

bool is_same(const ScaledView& a, const ScaledView& b) {
  return a.view.origin_x == b.view.origin_x && a.view.origin_y == b.view.origin_y &&
         a.view.cells_per_pixel == b.view.cells_per_pixel && a.level == b.level;
}

TEST(Trip, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const Map map = sample_map(40);
  const auto trip = plan_trip(map, {.seed = 1});
  EXPECT_TRUE(std::ranges::equal(trip, plan_trip(map, {.seed = 1}), is_same));
  EXPECT_FALSE(std::ranges::equal(trip, plan_trip(map, {.seed = 2}), is_same));
}

TEST(Trip, GoesFromTheSmallestScaleToTheLargestAndBackIn72Views) {
  const Map map = sample_map(40);
  const auto trip = plan_trip(map, {});
  ASSERT_THAT(trip, SizeIs(72));
  EXPECT_EQ(trip.front().scale, 250000);
  EXPECT_EQ(trip.back().scale, 250000);
  EXPECT_EQ(trip[35].scale, 3000);
  EXPECT_EQ(trip[36].scale, 3000);
  for (std::size_t i = 1; i < trip.size(); ++i) {
    if (i < 36) {
      EXPECT_LE(trip[i].scale, trip[i - 1].scale);
    } else {
      EXPECT_GE(trip[i].scale, trip[i - 1].scale);
    }
  }
}

TEST(Trip, HasTheScalesOfFigure7BothWays) {
  const Map map = sample_map(40);
  const auto trip = plan_trip(map, {});
  for (const double share : kFigureScales) {
    // The two closest views are consecutive.
    EXPECT_THAT(views_of_scale(trip, share * 250000), SizeIs(share == 3.0 / 250 ? 1 : 2));
  }
}

TEST(Trip, SeesSomethingInEveryView) {
  const Map map = sample_map(40);
  for (const ScaledView& view : plan_trip(map, {})) {
    const Box box = view.view.box();
    EXPECT_TRUE(std::ranges::any_of(map.layers, [&](const MapLayer& layer) {
      return std::ranges::any_of(layer.polygons.boxes,
                                 [&](const Box& polygon) { return polygon.intersects(box); });
    }));
  }
}

// At the equator a pixel of 0.28 mm is 70 m at 1:250,000.
TEST(Trip, ScalesAreThoseOfPixelsOf028Millimetres) {
  Map map;
  map.bounds = {-1000, -1000, 1000, 1000};
  const ScaledView view = view_around(map, {0, 0}, 250000, 1600, 1200, 0.25);
  const double metres_per_cell = 2 * 20037508.342789244 / 2147483648.0;
  EXPECT_NEAR(view.view.cells_per_pixel * metres_per_cell, 70, 1e-9);
  EXPECT_EQ(view.level, nearest_level(view.view.cells_per_pixel / 4));
}

}  // namespace
}  // namespace trapeze::experiment
