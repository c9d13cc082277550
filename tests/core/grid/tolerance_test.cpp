#include "core/grid/tolerance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace trapeze {
namespace {

TEST(Tolerance, DefaultOfEveryWholeZoomIsOnTheLadder) {
  for (int zoom = 0; zoom <= 22; ++zoom) {
    const double epsilon = 0.25 * std::exp2(23 - zoom);  // a quarter of a pixel
    EXPECT_EQ(epsilon_of_level(nearest_level(epsilon)), epsilon) << "zoom " << zoom;
  }
}

TEST(Tolerance, AnyToleranceIsWithinAQuarterOfAFactorOfTwoOfItsLevel) {
  for (double epsilon = 0.45; epsilon < 5e8; epsilon *= 1.013) {
    const double off = std::log2(epsilon_of_level(nearest_level(epsilon)) / epsilon);
    EXPECT_LE(std::abs(off), 0.25 + 1.0 / 512 + 1e-9) << epsilon;
  }
}

// The pixels of windows side by side differ by as much as their sides are rounded.
TEST(Tolerance, RoundedPixelsAtQuarterZoomsHaveOneLevel) {
  for (double zoom = 0.25; zoom < 18; zoom += 0.5) {
    const double epsilon = 0.25 * std::exp2(23 - zoom);
    EXPECT_EQ(nearest_level(epsilon * (1 - 2e-4)), nearest_level(epsilon * (1 + 2e-4))) << zoom;
  }
}

TEST(Tolerance, NothingIsDroppedBelowTheFirstLevel) {
  EXPECT_EQ(nearest_level(0), 0);
  EXPECT_EQ(nearest_level(0.1), 0);
  EXPECT_EQ(nearest_level(std::nan("")), 0);
}

TEST(Tolerance, LevelAboveIsTheFirstThatExceeds) {
  EXPECT_EQ(level_above(0), 1);
  for (int level = 1; level < kLastLevel; ++level) {
    const double epsilon = epsilon_of_level(static_cast<Level>(level));
    EXPECT_EQ(level_above(epsilon), level + 1);
    EXPECT_EQ(level_above(std::nextafter(epsilon, 0)), level);
  }
  EXPECT_EQ(level_above(1e12), kLastLevel + 1);
}

}  // namespace
}  // namespace trapeze
