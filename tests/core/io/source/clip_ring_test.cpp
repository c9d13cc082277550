#include "core/io/source/clip_ring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace trapeze {
namespace {

constexpr ClipWindow kUnit = {0, 0, 1, 1};

PositionRing clipped(PositionRing ring, const ClipWindow& window) {
  PositionRing scratch;
  clip_ring(ring, window, scratch);
  return ring;
}

double area(const PositionRing& ring) {
  double twice = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Position a = ring[i];
    const Position b = ring[(i + 1) % ring.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return std::abs(twice) / 2;
}

TEST(ClipRingTest, LeavesARingInsideAsItIs) {
  const PositionRing ring = {{0, 0}, {1, 0}, {0.5, 1}};
  EXPECT_EQ(clipped(ring, kUnit), ring);
}

TEST(ClipRingTest, LeavesNothingOfARingOutside) {
  EXPECT_TRUE(clipped({{2, 0}, {3, 0}, {3, 1}}, kUnit).empty());
  EXPECT_TRUE(clipped({{2, 2}, {3, 2}, {3, 3}}, kUnit).empty());
  EXPECT_TRUE(clipped({}, kUnit).empty());
}

TEST(ClipRingTest, CutsASquareThatCoversACorner) {
  EXPECT_DOUBLE_EQ(area(clipped({{0.5, 0.5}, {2, 0.5}, {2, 2}, {0.5, 2}}, kUnit)), 0.25);
}

TEST(ClipRingTest, GivesTheWindowForARingAroundIt) {
  EXPECT_DOUBLE_EQ(area(clipped({{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}, kUnit)), 1);
}

TEST(ClipRingTest, KeepsTheAreaOfARingCutIntoTwoParts) {
  // An upright U with its base outside: the arms remain, joined along the clip line.
  const PositionRing u = {{0, -1},      {1, -1},      {1, 1},    {0.75, 1},
                          {0.75, -0.5}, {0.25, -0.5}, {0.25, 1}, {0, 1}};
  EXPECT_DOUBLE_EQ(area(clipped(u, kUnit)), 0.5);
}

TEST(ClipRingTest, CutsAnEdgeAtTheSamePlaceInBothDirections) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> inside(0.1, 0.9);
  std::uniform_real_distribution<double> beyond(1.1, 1e6);
  for (int i = 0; i < 1000; ++i) {
    const Position a = {inside(random), inside(random)};
    const Position b = {beyond(random), inside(random)};
    const auto on_border = [](Position p) { return p.x == 1; };
    const PositionRing there = clipped({a, b, {0, 0}}, {0, -1e9, 1, 1e9});
    const PositionRing back = clipped({b, a, {0, 5}}, {0, -1e9, 1, 1e9});
    const auto cut_there = std::find_if(there.begin(), there.end(), on_border);
    ASSERT_NE(cut_there, there.end());
    EXPECT_NE(std::find(back.begin(), back.end(), *cut_there), back.end()) << "pair " << i;
  }
}

TEST(ClipRingTest, KeepsVerticesExactlyInTheWindowHoweverFarTheRingGoes) {
  std::mt19937 random(2);
  for (int i = 0; i < 1000; ++i) {
    std::uniform_real_distribution<double> exponent(-3, 308);
    std::bernoulli_distribution is_negative;
    PositionRing ring;
    for (int k = 0; k < 6; ++k) {
      const auto coordinate = [&] {
        return std::pow(10, exponent(random)) * (is_negative(random) ? -1 : 1);
      };
      const double x = coordinate();
      ring.push_back({x, coordinate()});
    }
    for (const Position p : clipped(ring, kUnit)) {
      ASSERT_TRUE(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1) << p.x << " " << p.y;
    }
  }
}

}  // namespace
}  // namespace trapeze
