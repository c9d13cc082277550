#include "core/adapt/farthest_vertex.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "bench/core/polygon_families.h"

namespace trapeze {
namespace {

/// Tests every vertex; resolves ties as documented.
FarthestVertex::Found by_looking_at_all(const std::vector<Point>& ring, std::size_t begin,
                                        std::size_t end) {
  const auto at = [&](std::size_t i) { return ring[i % ring.size()]; };
  const SegmentDistance distance(at(begin), at(end));
  FarthestVertex::Found best{begin + 1, -1};
  const auto off_middle = [&](std::size_t i) { return std::max(i - begin, end - i); };
  for (std::size_t i = begin + 1; i < end; ++i) {
    const double squared = distance.squared(at(i));
    const bool better = squared != best.squared ? squared > best.squared
                        : off_middle(i) != off_middle(best.vertex)
                            ? off_middle(i) < off_middle(best.vertex)
                            : is_above(at(i), at(best.vertex));
    if (better) best = {i, squared};
  }
  return best;
}

void expect_same_on_random_pieces(const std::vector<Point>& ring, unsigned seed) {
  FarthestVertex farthest;
  farthest.assign(ring);
  std::mt19937 random(seed);
  // Enough ranges to make the tree come into use: the first hundred or so searches test every
  // vertex.
  for (int piece = 0; piece < 300; ++piece) {
    const std::size_t begin = random() % ring.size();
    const std::size_t end = begin + 2 + random() % (ring.size() - 1);
    const auto found = farthest.find(begin, end);
    const auto wanted = by_looking_at_all(ring, begin, end);
    ASSERT_EQ(found.vertex, wanted.vertex)
        << "seed " << seed << ", piece " << begin << " .. " << end;
    ASSERT_EQ(found.squared, wanted.squared);
  }
}

TEST(FarthestVertex, IsThatOfLookingAtAllInEveryFamily) {
  for (const PolygonFamily& family : kPolygonFamilies) {
    SCOPED_TRACE(std::string(family.name));
    const Rings rings = family.make(3000);
    expect_same_on_random_pieces({rings[0].begin(), rings[0].end()}, 1);
  }
}

TEST(FarthestVertex, IsThatOfLookingAtAllOnRandomPoints) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    // Small ranges produce ties, large ones reach the ends of the grid.
    const std::int32_t reach = seed % 3 == 0 ? 5 : seed % 3 == 1 ? 10000 : kGridMax;
    std::uniform_int_distribution<std::int32_t> at(-reach, reach);
    std::vector<Point> ring(100 + random() % 1500);
    for (Point& p : ring) p = {at(random), at(random)};
    expect_same_on_random_pieces(ring, seed);
  }
}

TEST(FarthestVertex, OfEqualTeethTheOneInTheMiddleIsChosen) {
  std::vector<Point> ring;
  for (int i = 0; i < 1001; ++i) ring.push_back({10 * i, i % 2 == 0 ? 0 : 100});
  FarthestVertex farthest;
  farthest.assign(ring);
  EXPECT_EQ(farthest.find(0, 1000).vertex, 499u)
      << "499 and 501 are as near to the middle; 499 is above";
}

TEST(FarthestVertex, ForgetsTheRingBefore) {
  FarthestVertex farthest;
  for (const Rings& rings : {wiggly_star(5000), comb(2000), spiral(3000)}) {
    farthest.assign(rings[0]);
    const auto wanted = by_looking_at_all({rings[0].begin(), rings[0].end()}, 3, 1950);
    for (int again = 0; again < 200; ++again) {
      const auto found = farthest.find(3, 1950);
      ASSERT_EQ(found.vertex, wanted.vertex);
      ASSERT_EQ(found.squared, wanted.squared);
    }
  }
}

/// A convex polygon, from its top along the right side.
std::vector<Point> convex(std::size_t corners) {
  const Rings rings = spiky_star(2 * corners);
  std::vector<Point> hull;
  for (std::size_t i = 0; i < 2 * corners; i += 2) hull.push_back(rings[0][i]);
  const auto top = std::min_element(hull.begin(), hull.end(), is_above);
  std::rotate(hull.begin(), top, hull.end());
  return hull;
}

TEST(SegmentDistance, BoundOfAHullIsNoLessThanItsFarthestCornerAndAtMostHalfAsMuchAgain) {
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int32_t> at(kGridMin, kGridMax);
  for (const std::size_t corners : {3, 20, 33, 100, 5001}) {
    const std::vector<Point> hull = convex(corners);
    for (int i = 0; i < 300; ++i) {
      const Point a{at(random), at(random)};
      const Point b = i % 10 == 0 ? a : Point{at(random), at(random)};
      const SegmentDistance distance(a, b);
      double farthest = 0;
      for (const Point p : hull) farthest = std::max(farthest, distance.squared(p));
      const double bound = std::sqrt(distance.squared_bound(hull));
      ASSERT_GE(bound, std::sqrt(farthest) - 1e-5);
      ASSERT_LE(bound, 1.5 * std::sqrt(farthest));
    }
  }
}

TEST(SegmentDistance, IsToTheSegmentAndNotToItsLine) {
  const SegmentDistance distance({10, 0}, {0, 0});
  EXPECT_EQ(distance.squared({5, 7}), 49);
  EXPECT_EQ(distance.squared({-3, 4}), 25);
  EXPECT_EQ(distance.squared({13, -4}), 25);
  EXPECT_EQ(SegmentDistance({2, 2}, {2, 2}).squared({5, 6}), 25);
}

}  // namespace
}  // namespace trapeze
