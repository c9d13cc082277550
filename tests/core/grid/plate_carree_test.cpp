#include "core/grid/plate_carree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/grid/web_mercator.h"

namespace trapeze {
namespace {

constexpr double kCellsPerDegree = static_cast<double>(kGridMax) / 180;

TEST(PlateCarreeTest, RowsAreLatitudes) {
  for (const double latitude : {-85.0, -60.0, -1e-6, 0.0, 0.5, 45.0, 80.0, 85.05}) {
    const double y = grid_from_lonlat({0, latitude}).y;
    EXPECT_NEAR(plate_carree_from_mercator(y), -latitude * kCellsPerDegree, 1e-3) << latitude;
    EXPECT_NEAR(mercator_from_plate_carree(-latitude * kCellsPerDegree), y, 1e-2) << latitude;
    EXPECT_NEAR(mercator_stretch(y), 1 / std::cos(latitude * std::numbers::pi / 180), 1e-6);
  }
}

TEST(PlateCarreeTest, TheTableHasTheSameRows) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::int32_t> any(kGridMin, kGridMax);
  for (int i = 0; i < 100'000; ++i) {
    const std::int32_t y = any(random);
    ASSERT_NEAR(plate_carree_row(y), plate_carree_from_mercator(y), 0.5001) << y;
  }
  for (const std::int32_t y : {kGridMin, 0, kGridMax}) {
    EXPECT_EQ(plate_carree_row(y), std::lround(plate_carree_from_mercator(y)));
  }
}

TEST(PlateCarreeTest, PolesAreFarFromTheGrid) {
  for (const double y : {1.0 * kQuarterTurn, 1.5 * kQuarterTurn, 1e12}) {
    EXPECT_GT(mercator_from_plate_carree(y), 4.0 * kGridMax);
    EXPECT_LT(mercator_from_plate_carree(-y), 4.0 * kGridMin);
    EXPECT_TRUE(std::isfinite(mercator_from_plate_carree(y)));
  }
}

// The bound documented in the header, checked along sides anywhere on the map.
TEST(PlateCarreeTest, SidesOfStraightHeightAreNearTheirChords) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  double nearest_to_bound = 0;
  for (int i = 0; i < 3'000; ++i) {
    const double most = std::exp2(std::uniform_real_distribution<double>(-3, 20)(random));
    const auto height = static_cast<double>(straight_height(most));
    const double y = std::uniform_real_distribution<double>(kGridMin, kGridMax - height)(random);
    const double from = plate_carree_from_mercator(y);
    const double to = plate_carree_from_mercator(y + height);
    for (const double part : {0.1, 0.25, 0.5, 0.75, 0.9}) {
      const double off =
          std::abs(plate_carree_from_mercator(y + part * height) - (from + part * (to - from)));
      ASSERT_LE(off, most + 1e-6) << y << " " << height;
      nearest_to_bound = std::max(nearest_to_bound, off / most);
    }
  }
  EXPECT_GT(nearest_to_bound, 0.25) << "sides are cut more than is needed";
}

}  // namespace
}  // namespace trapeze
