#include "core/sweep/graph_builder.h"

#include <gtest/gtest.h>

#include <random>

#include "core/graph/check_graph.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {
namespace {

struct Built {
  BuildOutcome outcome;
  TrapezoidalGraph graph;
};

Built build(Rings rings) {
  Built b;
  GraphBuilder builder;
  b.outcome = builder.build(rings, b.graph);
  if (b.outcome.built) {
    EXPECT_EQ(check_graph(b.graph), "");
  }
  return b;
}

Built build(const std::string& text) {
  return build(rings_from_text(text));
}

std::int64_t doubled_area(const TrapezoidalGraph& g) {
  return static_cast<std::int64_t>(g.doubled_area());
}

TEST(GraphBuilder, TriangleIsTwoTrapezoidsInside) {
  const Built b = build("0 0, 10 5, 0 10");
  ASSERT_TRUE(b.outcome.built);
  EXPECT_FALSE(b.outcome.noded);
  EXPECT_EQ(b.graph.inside_nodes().size(), 2u);
  EXPECT_EQ(doubled_area(b.graph), 100);
}

TEST(GraphBuilder, SquareWithLevelSidesKeepsItsArea) {
  const Built b = build("0 0, 10 0, 10 10, 0 10");
  ASSERT_TRUE(b.outcome.built);
  EXPECT_EQ(doubled_area(b.graph), 200);
}

TEST(GraphBuilder, HoleIsNotInside) {
  const Built b = build("0 0, 100 0, 100 100, 0 100; 20 20, 20 40, 40 40, 40 20");
  EXPECT_EQ(doubled_area(b.graph), 2 * (100 * 100 - 20 * 20));
}

TEST(GraphBuilder, IslandInAHoleIsInsideAgain) {
  const Built b =
      build("0 0, 100 0, 100 100, 0 100; 20 20, 20 80, 80 80, 80 20; 40 40, 60 40, 60 60, 40 60");
  EXPECT_EQ(doubled_area(b.graph), 2 * (100 * 100 - 60 * 60 + 20 * 20));
}

TEST(GraphBuilder, OrientationAndOrderOfRingsDoNotMatter) {
  const Built a = build("0 0, 100 0, 100 100, 0 100; 20 20, 20 40, 40 40, 40 20");
  const Built b = build("40 20, 40 40, 20 40, 20 20; 100 0, 100 100, 0 100, 0 0");
  EXPECT_EQ(plain_trapezoids(a.graph), plain_trapezoids(b.graph));
}

TEST(GraphBuilder, RingsMayTouchAtAVertexWithoutNoding) {
  // A hole that hangs from a corner of the shell.
  const Built b = build("0 0, 100 0, 100 100, 0 100; 0 0, 30 60, 60 30");
  ASSERT_TRUE(b.outcome.built);
  EXPECT_FALSE(b.outcome.noded);
  EXPECT_EQ(doubled_area(b.graph), 20000 - 2700);
}

TEST(GraphBuilder, LoopThatVisitsAVertexTwiceIsCutInTwo) {
  // An hourglass drawn as one ring through its waist.
  const Built b = build("0 0, 20 0, 10 10, 20 20, 0 20, 10 10");
  ASSERT_TRUE(b.outcome.built);
  EXPECT_EQ(rings_of(b.graph).size(), 2u);
  EXPECT_EQ(doubled_area(b.graph), 400);
}

TEST(GraphBuilder, BowTieIsNodedAtItsCrossing) {
  const Built b = build("0 0, 20 20, 20 0, 0 20");
  ASSERT_TRUE(b.outcome.built);
  EXPECT_TRUE(b.outcome.noded);
  EXPECT_EQ(doubled_area(b.graph), 400);
}

TEST(GraphBuilder, VertexOnAnEdgeIsNoded) {
  const Built b = build("0 0, 100 0, 100 100, 0 100; 50 0, 60 20, 40 20");
  ASSERT_TRUE(b.outcome.built);
  EXPECT_TRUE(b.outcome.noded);
  EXPECT_EQ(doubled_area(b.graph), 20000 - 400);
}

TEST(GraphBuilder, TwoRingsThatShareAnEdgeBecomeOne) {
  const Built b = build("0 0, 10 0, 10 10, 0 10; 10 0, 20 0, 20 10, 10 10");
  ASSERT_TRUE(b.outcome.built);
  EXPECT_TRUE(b.outcome.noded);
  EXPECT_EQ(doubled_area(b.graph), 400);
  EXPECT_EQ(rings_of(b.graph).size(), 1u);
}

TEST(GraphBuilder, RingDrawnTwiceCancelsToNothing) {
  const Built b = build("0 0, 10 0, 10 10, 0 10; 0 0, 10 0, 10 10, 0 10");
  EXPECT_FALSE(b.outcome.built);
  EXPECT_EQ(b.outcome.failure, "");
}

TEST(GraphBuilder, SpikesDuplicatesAndCollapsedRingsAreDropped) {
  const Built b =
      build("0 0, 10 0, 10 0, 10 5, 30 5, 10 5, 10 10, 0 10; 50 50, 60 60; 70 70, 80 70, 75 70");
  ASSERT_TRUE(b.outcome.built);
  EXPECT_EQ(b.outcome.rings, 3u);
  EXPECT_EQ(b.outcome.collapsed_rings, 2u);
  EXPECT_EQ(doubled_area(b.graph), 200);
}

TEST(GraphBuilder, EmptyInputIsNotBuiltAndNotAFailure) {
  const Built b = build(Rings{});
  EXPECT_FALSE(b.outcome.built);
  EXPECT_EQ(b.outcome.failure, "");
}

TEST(GraphBuilder, WholeWorldIsExact) {
  const Built b = build(
      "-1073741824 -1073741824, 1073741824 -1073741824, 1073741824 1073741824, -1073741824 "
      "1073741824;"
      "-1073741823 -1073741823, 1073741823 1073741823, -1073741823 1073741822");
  ASSERT_TRUE(b.outcome.built);
}

TEST(GraphBuilder, RandomStarsWithHolesHaveTheAreaOfTheirRings) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    Rings rings;
    const double scale = seed % 3 == 0 ? 30 : seed % 3 == 1 ? 1000 : 5e8;
    const auto outer =
        random_star(random, {0, 0}, 5 + static_cast<int>(seed % 60), 0.5 * scale, scale);
    const auto hole =
        random_star(random, {0, 0}, 5 + static_cast<int>(seed % 17), 0.2 * scale, 0.35 * scale);
    const auto island =
        random_star(random, {0, 0}, 4 + static_cast<int>(seed % 7), 0.05 * scale, 0.15 * scale);
    rings.add(outer);
    rings.add(hole);
    rings.add(island);
    const std::int64_t area =
        doubled_area_of(outer) - doubled_area_of(hole) + doubled_area_of(island);
    const Built b = build(rings);
    ASSERT_TRUE(b.outcome.built);
    if (!b.outcome.noded) {
      EXPECT_EQ(doubled_area(b.graph), area);
    }
  }
}

TEST(GraphBuilder, RandomScribblesAreNodedToValidGraphs) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const int range = seed % 2 == 0 ? 12 : 1000000;
    std::uniform_int_distribution<std::int32_t> at(-range, range);
    Rings rings;
    for (int r = 0; r < 3; ++r) {
      for (int i = 0; i < 20; ++i) rings.points.push_back({at(random), at(random)});
      rings.close_ring();
    }
    const Built b = build(rings);
    EXPECT_EQ(b.outcome.failure, "");
  }
}

/// A ring that goes back and forth between the sides of a square, then up and down.
Rings lattice(std::int32_t lines) {
  Rings rings;
  const std::int32_t side = 10 * lines + 10;
  for (std::int32_t i = 1; i <= lines; ++i) {
    for (const std::int32_t x : {0, side})
      rings.points.push_back({i % 2 == 0 ? side - x : x, 10 * i});
  }
  rings.points.push_back({-10, side});
  for (std::int32_t i = 1; i <= lines; ++i) {
    for (const std::int32_t y : {0, side})
      rings.points.push_back({10 * i, i % 2 == 0 ? y : side - y});
  }
  rings.points.push_back({side, -10});
  rings.close_ring();
  return rings;
}

TEST(GraphBuilder, CrossesItselfAsOftenAsCanBeRepairedInASecond) {
  const Built b = build(lattice(60));
  EXPECT_EQ(b.outcome.failure, "");
  EXPECT_TRUE(b.outcome.noded);
  EXPECT_GT(b.outcome.vertices, 60u * 60u);
}

TEST(GraphBuilder, RefusesWhatCrossesItselfMoreOften) {
  const Built b = build(lattice(600));
  EXPECT_FALSE(b.outcome.built);
  EXPECT_EQ(b.outcome.failure, "crosses itself more than 262144 times");
}

TEST(GraphBuilder, IsTheSameWhateverWasBuiltBefore) {
  GraphBuilder builder;
  TrapezoidalGraph used;
  TrapezoidalGraph fresh;
  Rings first = rings_from_text("0 0, 20 20, 20 0, 0 20");
  Rings second = rings_from_text("0 0, 100 0, 100 100, 0 100; 20 20, 20 40, 40 40, 40 20");
  Rings again = second;
  builder.build(first, used);
  builder.build(second, used);
  GraphBuilder().build(again, fresh);
  EXPECT_EQ(used, fresh);
}

}  // namespace
}  // namespace trapeze
