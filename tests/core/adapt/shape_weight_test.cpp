#include "core/adapt/shape_weight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/adapt/adaptable_graph.h"
#include "core/sweep/graph_builder.h"
#include "tests/core/shapes/ring_text.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze {
namespace {

constexpr double kAlwaysKept = std::numeric_limits<double>::infinity();

using Line = ShapeWeights::Line;
using Points = std::vector<Point>;

std::vector<double> weigh(const Points& points, Line line) {
  std::vector<double> weights(points.size(), kAlwaysKept);
  ShapeWeights().weigh(points, line, weights);
  return weights;
}

/// The points of a ring that remain at a tolerance.
Points left_of(const Points& ring, double tolerance) {
  const std::vector<double> weights = weigh(ring, Line::ring);
  Points left;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (weights[i] >= tolerance) left.push_back(ring[i]);
  }
  return left;
}

/// The distinct weights in ascending order.
std::vector<double> steps_of(const Points& points, Line line = Line::ring) {
  std::set<double> steps;
  for (const double weight : weigh(points, line)) {
    if (std::isfinite(weight)) steps.insert(weight);
  }
  return {steps.begin(), steps.end()};
}

Points turned(const Points& points, double degrees) {
  Points result;
  const double cosine = std::cos(degrees * M_PI / 180);
  const double sine = std::sin(degrees * M_PI / 180);
  for (const Point p : points) {
    result.push_back({static_cast<std::int32_t>(std::lround(p.x * cosine - p.y * sine)),
                      static_cast<std::int32_t>(std::lround(p.x * sine + p.y * cosine))});
  }
  return result;
}

// A bump in the wall of a rectangle.
//
//   0,0 ----------------- 10,0
//    |                      |
//   0,6 -- 3,6   5,6 -- 10,6
//           |     |
//          3,7 - 5,7
const Points kBump{{0, 0},         {100000, 0},    {100000, 60000}, {50000, 60000},
                   {50000, 70000}, {30000, 70000}, {30000, 60000},  {0, 60000}};
const Points kRectangle{{0, 0}, {100000, 0}, {100000, 60000}, {0, 60000}};

TEST(ShapeWeights, ABumpGoesAtOneToleranceAndLeavesTheRectangle) {
  for (const double degrees : {0.0, 17.0, 45.0, 80.0}) {
    const Points bump = turned(kBump, degrees);
    const std::vector<double> steps = steps_of(bump);
    // In a rotated ring, the wall is straight only to within a cell, and the ends of the bump are
    // removed a little later.
    const double after = steps.front() * 1.001;
    EXPECT_EQ(left_of(bump, after), turned(kRectangle, degrees)) << degrees;
    EXPECT_EQ(left_of(bump, steps.front()), bump) << degrees;
  }
}

TEST(ShapeWeights, TheCornersOfARectangleGoLastAndTogether) {
  for (const double degrees : {0.0, 17.0, 45.0, 80.0}) {
    const Points bump = turned(kBump, degrees);
    const Points rectangle = turned(kRectangle, degrees);
    const double last = steps_of(bump).back();
    EXPECT_EQ(left_of(bump, last), rectangle) << degrees;
    EXPECT_LE(left_of(bump, last * 1.001).size(), 2u) << degrees;
  }
}

TEST(ShapeWeights, BothEndsOfAJogGoTogether) {
  const Points jog{{0, 0},         {100000, 0},    {100000, 60000},
                   {50000, 60000}, {50000, 62000}, {0, 62000}};
  const std::vector<double> weights = weigh(jog, Line::ring);
  EXPECT_EQ(weights[3], weights[4]);
  EXPECT_EQ(weights[3], steps_of(jog).front());
  EXPECT_EQ(std::ranges::count(weights, weights[3]), 2);
}

TEST(ShapeWeights, WhatIsFlatterOrSkewerGoesBeforeEqualAreas) {
  const double upright = cost_of_vertex({0, 0}, {500, 1000}, {1000, 0});
  const double flat = cost_of_vertex({0, 0}, {5000, 100}, {10000, 0});
  const double skew = cost_of_vertex({0, 0}, {1100, 1000}, {1000, 0});
  EXPECT_LT(flat, upright / 2);
  EXPECT_LT(skew, upright);
}

TEST(ShapeWeights, ARightAngleCountsMoreThanOneNearlyRight) {
  const auto at = [](double degrees) {  // the angle, between equal sides
    const double half = degrees / 2 * M_PI / 180;
    const auto x = static_cast<std::int32_t>(std::lround(1e6 * std::sin(half)));
    const auto y = static_cast<std::int32_t>(std::lround(1e6 * std::cos(half)));
    const double area = 1e12 * std::sin(half) * std::cos(half);
    return cost_of_vertex({-x, y}, {0, 0}, {x, y}) / area;
  };
  EXPECT_NEAR(at(90), 4, 0.01);
  EXPECT_LT(at(85), at(90));
  EXPECT_LT(at(95), at(90));
  EXPECT_LT(at(78), 1.01);
  EXPECT_LT(at(102), 1.01);
}

TEST(ShapeWeights, OfTwoVerticesOnBothSidesOfTheNewBoundaryBothTrianglesCount) {
  // A low step, halved by the new boundary: it is flat, and no right angle of its walls is lost.
  EXPECT_NEAR(cost_of_pair({0, 0}, {10000, 0}, {10000, 100}, {20000, 100}), 500000 * 0.2575, 7000);
  // A step as high as its walls are long: its right angles are lost.
  EXPECT_DOUBLE_EQ(cost_of_pair({0, 0}, {100, 0}, {100, 100}, {200, 100}), 4 * 5000);
  // A square bump on one side.
  EXPECT_DOUBLE_EQ(cost_of_pair({0, 0}, {0, 100}, {100, 100}, {100, 0}), 10000);
}

TEST(ShapeWeights, CostsAreTheSameFromBothSides) {
  std::mt19937 random(5);
  const auto point = [&random] {
    return Point{static_cast<std::int32_t>(random() >> 1) - (1 << 30),
                 static_cast<std::int32_t>(random() >> 1) - (1 << 30)};
  };
  for (int i = 0; i < 10000; ++i) {
    const Point p = point();
    const Point v = point();
    const Point w = point();
    const Point q = point();
    ASSERT_EQ(cost_of_vertex(p, v, q), cost_of_vertex(q, v, p));
    ASSERT_EQ(cost_of_pair(p, v, w, q), cost_of_pair(q, w, v, p));
    ASSERT_GE(cost_of_vertex(p, v, q), 0);
    ASSERT_GE(cost_of_pair(p, v, w, q), 0);
  }
}

/// Recomputes everything after every step.
std::vector<double> weights_the_plain_way(const Points& points, Line line) {
  std::vector<double> weights(points.size(), kAlwaysKept);
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < points.size(); ++i) left.push_back(i);
  double greatest = 0;
  while (left.size() > 2) {
    const std::size_t n = left.size();
    const auto at = [&](std::size_t k) { return points[left[k % n]]; };
    const auto is_end = [&](std::size_t k) {
      return line == Line::arc && (k % n == 0 || k % n + 1 == n);
    };
    struct Choice {
      double cost;
      int count;
      Point upper;
      Point lower;
      std::size_t k;
    };
    std::vector<Choice> choices;
    for (std::size_t k = 0; k < n; ++k) {
      if (is_end(k)) continue;
      choices.push_back({cost_of_vertex(at(k + n - 1), at(k), at(k + 1)), 1, at(k), at(k), k});
      if (n < 4 || is_end(k + 1)) continue;
      const auto [upper, lower] = std::minmax({at(k), at(k + 1)}, is_above);
      choices.push_back(
          {cost_of_pair(at(k + n - 1), at(k), at(k + 1), at(k + 2)), 2, upper, lower, k});
    }
    const Choice best = *std::ranges::min_element(choices, [](const Choice& a, const Choice& b) {
      if (a.cost != b.cost) return a.cost < b.cost;
      if (a.count != b.count) return a.count < b.count;
      return a.upper != b.upper ? is_above(a.upper, b.upper) : is_above(a.lower, b.lower);
    });
    greatest = std::max(greatest, best.cost);
    std::vector<std::size_t> gone{left[best.k]};
    if (best.count == 2) gone.push_back(left[(best.k + 1) % n]);
    for (const std::size_t v : gone) {
      weights[v] = std::sqrt(greatest);
      std::erase(left, v);
    }
  }
  return weights;
}

TEST(ShapeWeights, AreThoseOfRemovingWhatCostsLeastEachTime) {
  int count = 0;
  for (unsigned seed = 0; seed < 140; ++seed) {
    const Rings rings = random_shape(seed);
    for (std::size_t r = 0; r < rings.size() && r < 3; ++r) {
      const Points ring(rings[r].begin(), rings[r].end());
      std::set<std::pair<std::int32_t, std::int32_t>> places;
      for (const Point p : ring) places.insert({p.x, p.y});
      if (ring.size() < 3 || ring.size() > 300 || places.size() < ring.size()) continue;
      ASSERT_EQ(weigh(ring, Line::ring), weights_the_plain_way(ring, Line::ring)) << seed;
      ASSERT_EQ(weigh(ring, Line::arc), weights_the_plain_way(ring, Line::arc)) << seed;
      ++count;
    }
  }
  EXPECT_GT(count, 50);
}

TEST(ShapeWeights, OfAnArcAreThoseOfTheArcBackwards) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Rings rings = random_shape(seed);
    if (rings.empty()) continue;
    Points arc(rings[0].begin(), rings[0].end());
    std::vector<double> weights = weigh(arc, Line::arc);
    EXPECT_EQ(weights.front(), kAlwaysKept);
    EXPECT_EQ(weights.back(), kAlwaysKept);
    EXPECT_LE(std::ranges::count(weights, kAlwaysKept), 2);
    std::ranges::reverse(arc);
    std::ranges::reverse(weights);
    EXPECT_EQ(weigh(arc, Line::arc), weights) << seed;
  }
}

TEST(ShapeWeights, AnArcOfTwoPointsAndOneThatEndsWhereItBegins) {
  EXPECT_EQ(weigh({{0, 0}, {5, 5}}, Line::arc), (std::vector<double>{kAlwaysKept, kAlwaysKept}));
  const std::vector<double> weights = weigh({{0, 0}, {10, 0}, {10, 10}, {0, 0}}, Line::arc);
  EXPECT_EQ(weights[1], weights[2]);
  EXPECT_TRUE(std::isfinite(weights[1]));
}

TEST(ShapeWeights, NoWallIsAskewAtAnyTolerance) {
  Rings rings;
  rings.add(kBump);
  const auto has_askew = [&](WeightRule rule) {
    TrapezoidalGraph graph;
    Rings copy = rings;
    EXPECT_TRUE(GraphBuilder().build(copy, graph).built);
    AdaptableGraph adaptable(std::move(graph), {.weights = rule});
    std::set<std::size_t> numbers;
    bool found = false;
    for (double epsilon = 1; !rings_of(adaptable.graph()).empty(); epsilon *= 1.01) {
      adaptable.adapt_to(epsilon);
      const std::vector<Point> points = rings_of(adaptable.graph()).points;
      numbers.insert(points.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Point next = points[(i + 1) % points.size()];
        found = found || (points[i].x != next.x && points[i].y != next.y);
      }
    }
    EXPECT_TRUE(numbers.contains(8));
    EXPECT_TRUE(numbers.contains(4));
    return found;
  };
  EXPECT_FALSE(has_askew(WeightRule::shape));
  EXPECT_TRUE(has_askew(WeightRule::douglas_peucker));
}

}  // namespace
}  // namespace trapeze
