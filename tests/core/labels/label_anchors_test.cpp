#include "core/labels/label_anchors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "tests/core/shapes/layers.h"

namespace trapeze {
namespace {

using Ring = std::vector<Point>;

Rings rings_of(const std::vector<Ring>& all) {
  Rings rings;
  for (const Ring& ring : all) rings.add(ring);
  return rings;
}

Ring box(std::int32_t min_x, std::int32_t min_y, std::int32_t max_x, std::int32_t max_y) {
  return {{min_x, min_y}, {max_x, min_y}, {max_x, max_y}, {min_x, max_y}};
}

bool is_inside(const Rings& rings, double x, double y) {
  bool inside = false;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const auto ring = rings[i];
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Point a = ring[k];
      const Point b = ring[(k + 1) % ring.size()];
      if ((a.y > y) == (b.y > y)) continue;
      const double share = (y - a.y) / (static_cast<double>(b.y) - a.y);
      if (a.x + share * (static_cast<double>(b.x) - a.x) < x) inside = !inside;
    }
  }
  return inside;
}

/// A star of random spikes around a position: simple, and seldom convex.
Ring star(std::mt19937& random, Point middle, int corners, double least, double most) {
  Ring ring;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    const double radius = std::uniform_real_distribution(least, most)(random);
    ring.push_back({static_cast<std::int32_t>(std::lround(middle.x + radius * std::cos(angle))),
                    static_cast<std::int32_t>(std::lround(middle.y + radius * std::sin(angle)))});
  }
  return ring;
}

/// The greatest depth found inside the rings by sampling many positions.
double deepest(const Rings& rings, double step) {
  Box bounds;
  for (const Point p : rings.points) bounds.include(p);
  const auto depth_at = [&](double x, double y) {
    double nearest = 1e300;
    for (std::size_t i = 0; i < rings.size(); ++i) {
      const auto ring = rings[i];
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const double ax = ring[k].x / LabelAnchors::kSqueeze;
        const double ay = ring[k].y;
        const double dx = ring[(k + 1) % ring.size()].x / LabelAnchors::kSqueeze - ax;
        const double dy = ring[(k + 1) % ring.size()].y - ay;
        const double px = x / LabelAnchors::kSqueeze - ax;
        const double along = std::clamp((px * dx + (y - ay) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
        nearest = std::min(nearest, std::hypot(px - along * dx, y - ay - along * dy));
      }
    }
    return nearest;
  };
  double most = 0;
  for (double y = bounds.min_y; y < bounds.max_y; y += step) {
    for (double x = bounds.min_x; x < bounds.max_x; x += step) {
      if (is_inside(rings, x, y)) most = std::max(most, depth_at(x, y));
    }
  }
  return most;
}

TEST(LabelAnchorsTest, OfBoxesIsInTheMiddle) {
  const auto wide = anchors_of_feature(7, rings_of({box(0, 0, 12'000, 1'000)}));
  ASSERT_EQ(wide.size(), 1u);
  EXPECT_EQ(wide[0].row, 7u);
  EXPECT_NEAR(wide[0].depth, 500, 500 * LabelAnchors::kDepthShare);
  EXPECT_EQ(wide[0].place, (Point{6'000, 500}));
  EXPECT_EQ(wide[0].area, 12e6F);
  // Where a name has less width than it needs for its height, the width counts.
  const auto high = anchors_of_feature(0, rings_of({box(0, 0, 600, 6'000)}));
  ASSERT_EQ(high.size(), 1u);
  EXPECT_NEAR(high[0].depth, 100, 100 * LabelAnchors::kDepthShare);
  EXPECT_EQ(high[0].place, (Point{300, 3'000}));
  const auto square = anchors_of_feature(0, rings_of({box(100'003, 7, 103'010, 3'013)}));
  ASSERT_EQ(square.size(), 1u);
  EXPECT_NEAR(square[0].place.x, 101'506.5, 1);
  EXPECT_NEAR(square[0].place.y, 1'510, 1);
}

TEST(LabelAnchorsTest, AHoleIsAvoidedAndItsIslandIsAPart) {
  const Rings rings =
      rings_of({box(40'000, 4'000, 60'000, 6'000), box(0, 0, 100'000, 10'000),
                box(30'000, 3'000, 70'000, 7'000), box(200'000, 0, 210'000, 10'000)});
  const auto anchors = anchors_of_feature(0, rings);
  ASSERT_EQ(anchors.size(), 3u);
  EXPECT_EQ(anchors[0].area, 1e9F - 16e7F);
  EXPECT_TRUE(is_inside(rings, anchors[0].place.x, anchors[0].place.y));
  EXPECT_TRUE(anchors[0].place.x < 30'000 || anchors[0].place.x > 70'000);
  EXPECT_EQ(anchors[1].area, 1e8F);
  EXPECT_GT(anchors[1].place.x, 200'000);
  EXPECT_EQ(anchors[2].area, 4e7F);
  EXPECT_NEAR(anchors[2].place.y, 5'000, 100);
}

TEST(LabelAnchorsTest, WhatLiesOverAFeatureIsAvoided) {
  const Rings land = rings_of({box(0, 0, 90'000, 10'000)});
  const std::vector<Rings> above = {rings_of({box(-5, -5, 60'000, 10'005)}),
                                    rings_of({box(50'000, 0, 70'000, 10'000)})};
  const auto anchors = anchors_of_feature(0, land, above);
  ASSERT_EQ(anchors.size(), 1u);
  EXPECT_NEAR(anchors[0].place.x, 80'000, 1'000);
  const std::vector<Rings> all = {rings_of({box(-5, -5, 95'000, 10'005)})};
  EXPECT_TRUE(anchors_of_feature(0, land, all).empty());
}

TEST(LabelAnchorsTest, NothingIsDeeper) {
  std::mt19937 random(5);
  for (int i = 0; i < 30; ++i) {
    Rings rings = rings_of({star(random, {0, 0}, 40, 1'500, 6'000)});
    if (i % 2 == 0) rings.add(star(random, {0, 0}, 20, 300, 1'400));
    const auto anchors = anchors_of_feature(0, rings);
    ASSERT_EQ(anchors.size(), 1u);
    EXPECT_TRUE(is_inside(rings, anchors[0].place.x, anchors[0].place.y));
    EXPECT_GE(anchors[0].depth, deepest(rings, 60) * (1 - LabelAnchors::kDepthShare) - 1);
    // The whole ellipse lies inside.
    for (int k = 0; k < 360; ++k) {
      const double angle = k * std::numbers::pi / 180;
      const double part = 0.999;
      EXPECT_TRUE(is_inside(
          rings,
          anchors[0].place.x + part * LabelAnchors::kSqueeze * anchors[0].depth * std::cos(angle),
          anchors[0].place.y + part * anchors[0].depth * std::sin(angle)));
    }
  }
}

/// A ring with right angles, rotated by an angle, so that its space lies between opposite walls.
Ring turned(const Ring& ring, double angle) {
  Ring made;
  for (const Point p : ring) {
    made.push_back({static_cast<std::int32_t>(p.x * std::cos(angle) - p.y * std::sin(angle)),
                    static_cast<std::int32_t>(p.x * std::sin(angle) + p.y * std::cos(angle))});
  }
  return made;
}

TEST(LabelAnchorsTest, NothingIsDeeperBetweenWalls) {
  std::mt19937 random(8);
  std::uniform_int_distribution<std::int32_t> length(300, 6'000);
  std::uniform_real_distribution<double> angle(0, std::numbers::pi);
  for (int i = 0; i < 60; ++i) {
    // An L with arms of any width; some are divided into short sides.
    const std::int32_t wide = length(random);
    const std::int32_t high = length(random);
    const std::int32_t across = wide / 4 + length(random) * wide / 12'000;
    const std::int32_t down = high / 4 + length(random) * high / 12'000;
    Ring corners{{0, 0}, {wide, 0}, {wide, down}, {across, down}, {across, high}, {0, high}};
    Ring ring;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Point a = corners[k];
      const Point b = corners[(k + 1) % corners.size()];
      const int pieces = i % 3 == 0 ? 7 : 1;
      for (int j = 0; j < pieces; ++j) {
        ring.push_back({a.x + (b.x - a.x) * j / pieces, a.y + (b.y - a.y) * j / pieces});
      }
    }
    const Rings rings = rings_of({turned(ring, i % 2 == 0 ? 0 : angle(random))});
    const auto anchors = anchors_of_feature(0, rings);
    ASSERT_EQ(anchors.size(), 1u);
    const double greatest = deepest(rings, std::min(wide, high) / 60.0);
    EXPECT_GE(anchors[0].depth, greatest * (1 - LabelAnchors::kDepthShare) - 1);
    EXPECT_LE(anchors[0].depth, greatest * 1.1) << "no boundary is nearer than that";
  }
}

TEST(LabelAnchorsTest, AStripThatIsSeenIsFound) {
  const Rings land = rings_of({turned(box(0, 0, 90'000, 30'000), 0.3)});
  for (const std::int32_t seen : {30'000, 3'000, 1'000}) {
    const std::vector<Rings> above = {rings_of({turned(box(0, 0, 90'000 - seen, 30'000), 0.3)})};
    const auto anchors = anchors_of_feature(0, land, above);
    ASSERT_EQ(anchors.size(), 1u) << seen;
    EXPECT_GT(anchors[0].depth, 0);
    EXPECT_FALSE(is_inside(above[0], anchors[0].place.x, anchors[0].place.y));
  }
}

TEST(LabelAnchorsTest, UnderALargeFeatureOnlyWhatIsSeenCounts) {
  std::mt19937 random(11);
  std::uniform_int_distribution<std::int32_t> place(-40'000, 40'000);
  int covered = 0;
  int partly = 0;
  for (int i = 0; i < 400; ++i) {
    // A feature of many spikes, with a hole, over a small one somewhere around its boundary.
    Rings large = rings_of({star(random, {0, 0}, 300, 15'000, 45'000)});
    large.add(star(random, {0, 0}, 100, 4'000, 12'000));
    const Rings small = rings_of({star(random, {place(random), place(random)}, 12, 900, 3'000)});
    const std::vector<Rings> above = {large};
    const auto is_seen = [&](double x, double y) {
      return is_inside(small, x, y) && !is_inside(large, x, y);
    };
    const auto anchors = anchors_of_feature(0, small, above);
    Box bounds;
    for (const Point p : small.points) bounds.include(p);
    // The greatest circle, drawn wider, of which everything is seen, by sampling.
    double deepest = 0;
    for (double y = bounds.min_y; y < bounds.max_y; y += 400) {
      for (double x = bounds.min_x; x < bounds.max_x; x += 400) {
        double depth = 0;
        const auto is_free = [&](double radius) {
          for (int k = 0; k < 24; ++k) {
            const double angle = k * std::numbers::pi / 12;
            const double to_x = x + radius * LabelAnchors::kSqueeze * std::cos(angle);
            if (!is_seen(to_x, y + radius * std::sin(angle))) return false;
          }
          return true;
        };
        while (is_seen(x, y) && is_free(depth + 50)) depth += 50;
        deepest = std::max(deepest, depth);
      }
    }
    if (anchors.empty()) {
      EXPECT_LT(deepest, 100) << i;
      ++covered;
      continue;
    }
    ASSERT_EQ(anchors.size(), 1u);
    EXPECT_TRUE(is_seen(anchors[0].place.x, anchors[0].place.y)) << i;
    partly += anchors[0].depth < 300 ? 1 : 0;
    // Spikes may reach between the directions of the sampled circle, so that it may be too large.
    EXPECT_GE(anchors[0].depth, deepest * 0.6 - 100) << i;
  }
  EXPECT_GT(covered, 20);
  EXPECT_GT(partly, 20);
}

TEST(LabelAnchorsTest, OfWhatIsAsItWasIsTakenOver) {
  const Rings house = rings_of({box(0, 0, 3'000, 1'000)});
  const Rings field = rings_of({box(10'000, 0, 40'000, 9'000)});
  const Rings pond = rings_of({box(20'000, 2'000, 26'000, 5'000)});
  const Rings other_pond = rings_of({box(20'000, 2'000, 27'000, 5'000)});
  const std::unique_ptr<Layer> before = layer_of({field, house, pond});
  const LabelAnchors found(*before, LabelParts::all);
  std::vector<LabelAnchor> marked(found.all().begin(), found.all().end());
  ASSERT_EQ(marked.size(), 3u);
  for (LabelAnchor& anchor : marked) anchor.depth = 1;  // marks anchors that are taken over

  // In another order: the building and the pond are unchanged, but not the features over the field.
  const std::unique_ptr<Layer> after = layer_of({house, field, other_pond, pond});
  const LabelAnchors anew(*after, LabelParts::all);
  const LabelAnchors again(*after, KnownAnchors{before.get(), marked});
  ASSERT_EQ(again.all().size(), anew.all().size());
  for (std::size_t i = 0; i < again.all().size(); ++i) {
    LabelAnchor anchor = again.all()[i];
    const bool is_known = anchor.row == 0 || anchor.row == 3;
    EXPECT_EQ(anchor.depth == 1, is_known) << anchor.row;
    anchor.depth = anew.all()[i].depth;
    EXPECT_EQ(anchor, anew.all()[i]);
  }
  const LabelAnchors of_nothing(*after, KnownAnchors{before.get(), {}});
  EXPECT_TRUE(std::ranges::equal(of_nothing.all(), anew.all()));
}

TEST(LabelAnchorsTest, DegenerateRingsHaveNone) {
  EXPECT_TRUE(anchors_of_feature(0, {}).empty());
  EXPECT_TRUE(anchors_of_feature(0, rings_of({{{0, 0}, {10, 10}}})).empty());
  EXPECT_TRUE(anchors_of_feature(0, rings_of({{{0, 0}, {100, 0}, {50, 0}}})).empty());
}

TEST(LabelAnchorsTest, ThousandsOfIslandsAreFoundInTheirSea) {
  std::vector<Ring> rings;
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) rings.push_back(box(x * 100, y * 100, x * 100 + 60, y * 100 + 30));
  }
  rings.push_back(box(-1'000, -1'000, 10'000, 10'000));
  const auto anchors = anchors_of_feature(0, rings_of(rings));
  ASSERT_EQ(anchors.size(), 1u) << "each of the islands is a hole";
  EXPECT_FLOAT_EQ(anchors[0].area, 11'000.0F * 11'000 - 3'600 * 1'800);
}

}  // namespace
}  // namespace trapeze
