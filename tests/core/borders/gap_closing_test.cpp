#include "core/borders/gap_closing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "core/borders/coverage_builder.h"
#include "core/graph/check_graph.h"
#include "core/grid/web_mercator.h"
#include "tests/core/borders/coverage_shapes.h"

namespace trapeze {
namespace {

using ::testing::UnorderedElementsAre;

/// So many metres on the ground as these cells are near the equator.
double metres_of(double cells) {
  return cells / cells_from_ground(1, 0);
}

using Texts = std::vector<std::string>;

/// Features, and what becomes of them.
struct Closing {
  std::vector<Rings> features;
  GapClosing done;

  explicit Closing(std::vector<Rings> given, double cells) : features(std::move(given)) {
    std::vector<Rings*> pointers;
    for (Rings& rings : features) pointers.push_back(&rings);
    done = close_gaps(pointers, metres_of(cells));
  }
  Closing(const Texts& texts, double cells) : Closing(rings_of(texts), cells) {}

  CoverageOutcome build(double widest_gap_cells, TrapezoidalGraph& graph) const {
    std::vector<const Rings*> pointers;
    for (const Rings& rings : features) pointers.push_back(&rings);
    return CoverageBuilder().build(
        pointers, {std::numeric_limits<double>::infinity(), metres_of(widest_gap_cells)}, graph);
  }
  CoverageOutcome build(double widest_gap_cells = 0) const {
    TrapezoidalGraph graph;
    const CoverageOutcome outcome = build(widest_gap_cells, graph);
    EXPECT_EQ(check_graph(graph), "");
    return outcome;
  }

 private:
  static std::vector<Rings> rings_of(const Texts& texts) {
    std::vector<Rings> rings;
    for (const std::string& text : texts) rings.push_back(rings_from_text(text));
    return rings;
  }
};

TEST(GapClosing, NeighboursBesideEachOtherGetACommonBorder) {
  const Closing c(Texts{"0 0, 100 0, 100 100, 0 100", "103 0, 200 0, 200 100, 103 100"}, 4);
  EXPECT_EQ(c.done.moved, 2u);
  EXPECT_EQ(c.done.led, 0u);
  const CoverageOutcome outcome = c.build();
  EXPECT_EQ(outcome.shared_edges, 1u);
  EXPECT_EQ(outcome.vertices, 6u);
  EXPECT_TRUE(outcome.overlaps.empty());
}

TEST(GapClosing, OverlapsAreClosedAsGapsAre) {
  const Closing c(Texts{"0 0, 103 0, 103 100, 0 100", "100 0, 200 0, 200 100, 100 100"}, 4);
  EXPECT_EQ(c.build().shared_edges, 1u);
  EXPECT_TRUE(c.build().overlaps.empty());
}

TEST(GapClosing, WhatIsFartherApartStays) {
  const Texts texts = {"0 0, 100 0, 100 100, 0 100", "105 0, 200 0, 200 100, 105 100"};
  const Closing c(texts, 4);
  EXPECT_EQ(c.done.moved + c.done.led, 0u);
  EXPECT_EQ(c.features[0].points, rings_from_text(texts[0]).points);
  EXPECT_EQ(c.features[1].points, rings_from_text(texts[1]).points);
}

TEST(GapClosing, EdgesAreLedThroughVerticesOfTheOtherSide) {
  const Closing c(
      Texts{"0 0, 100 0, 100 100, 0 100", "100 0, 200 0, 200 100, 100 100, 102 60, 103 40"}, 4);
  EXPECT_EQ(c.done.moved, 0u);
  EXPECT_EQ(c.done.led, 2u);
  EXPECT_THAT(c.features[0].points,
              UnorderedElementsAre(Point{0, 0}, Point{100, 0}, Point{103, 40}, Point{102, 60},
                                   Point{100, 100}, Point{0, 100}));
  EXPECT_EQ(c.build().shared_edges, 3u);
}

TEST(GapClosing, ThreeCornersMeetInOnePlace) {
  const Closing c(Texts{"0 0, 100 0, 100 50, 0 50", "0 53, 49 53, 49 100, 0 100",
                        "52 52, 100 52, 100 100, 52 100"},
                  6);
  const CoverageOutcome outcome = c.build();
  EXPECT_EQ(outcome.gaps, 0u);
  EXPECT_EQ(outcome.shared_edges, 3u);
  EXPECT_EQ(outcome.junctions, 4u);
}

TEST(GapClosing, DetailOfASinglePolygonIsNotTouched) {
  const std::string text = "0 0, 50 0, 51 1, 52 0, 53 1, 100 0, 100 100, 0 100";
  const Closing alone(Texts{text}, 4);
  EXPECT_EQ(alone.features[0].points, rings_from_text(text).points);
  // Nor where both sides have it.
  const std::string below = "0 0, 50 0, 51 1, 52 0, 53 1, 100 0, 100 -90, 0 -90";
  const Closing both(Texts{text, below}, 4);
  EXPECT_EQ(both.done.moved + both.done.led, 0u);
  EXPECT_EQ(both.features[1].points, rings_from_text(below).points);
}

TEST(GapClosing, PolygonNarrowerThanTheGapMayGo) {
  const Closing c(Texts{"0 0, 100 0, 100 100, 0 100", "101 0, 102 0, 102 100, 101 100",
                        "103 0, 200 0, 200 100, 103 100"},
                  4);
  const CoverageOutcome outcome = c.build();
  EXPECT_EQ(outcome.gaps, 0u);
  EXPECT_EQ(outcome.failure, "");
}

TEST(GapClosing, DistancesAreOfTheGround) {
  // At 60 degrees north a metre is twice as many cells.
  const auto north = static_cast<int>(grid_from_lonlat({0, 60}).y);
  const auto box = [north](int left, int right) {
    Rings rings;
    rings.add(std::vector<Point>{
        {left, north}, {right, north}, {right, north + 100}, {left, north + 100}});
    return rings;
  };
  EXPECT_EQ(Closing(std::vector<Rings>{box(0, 100), box(107, 200)}, 4).done.moved, 2u);
  EXPECT_EQ(Closing(std::vector<Rings>{box(0, 100), box(109, 200)}, 4).done.moved, 0u);
}

TEST(GapClosing, NarrowPlacesBetweenBordersAreFilled) {
  // A lens of 4 cells at its widest, and a hole in the middle of one feature as narrow.
  const Closing c(
      Texts{"0 0, 100 0, 100 20, 98 50, 100 80, 100 100, 0 100; 40 20, 42 20, 42 80, 40 80",
            "100 0, 200 0, 200 100, 100 100, 100 80, 102 50, 100 20"},
      0.1);
  EXPECT_EQ(c.build().gaps, 1u);
  EXPECT_EQ(c.build(1.9).gaps, 1u) << "its mean width is two cells";
  TrapezoidalGraph graph;
  const CoverageOutcome outcome = c.build(2.1, graph);
  EXPECT_EQ(check_graph(graph), "");
  EXPECT_EQ(outcome.gaps, 0u);
  EXPECT_EQ(outcome.filled, 1u);
  // To the first one of two with as long a border; the hole is nobody's gap.
  EXPECT_EQ(static_cast<int>(graph.doubled_areas()[1]), 2 * (100 * 100 - 2 * 60) + 120);
}

/// A grid of cells that all belong to someone, each drawn by itself: no vertex is where that of the
/// neighbour is, and some are missing.
std::vector<Rings> carelessly_drawn(unsigned seed) {
  constexpr int kWidth = 300;
  constexpr int kCells = 4;
  std::mt19937 random(seed);
  const auto between = [&](int a, int b) {
    return std::uniform_int_distribution<int>(a, b)(random);
  };
  const auto wiggle = [](int along, int line) { return (along * 37 + line * 101) % 7 - 3; };
  std::vector<Rings> features;
  for (int y = 0; y < kCells; ++y) {
    for (int x = 0; x < kCells; ++x) {
      std::vector<Point> ring;
      const auto add = [&](Point p) {
        const bool is_corner = p.x % kWidth == 0 && p.y % kWidth == 0;
        if (!is_corner && between(0, 9) == 0) return;
        // Between the same neighbours everybody means the same line.
        const int dx = p.x % kWidth == 0 && !is_corner ? wiggle(p.y, p.x) : 0;
        const int dy = p.y % kWidth == 0 && !is_corner ? wiggle(p.x, p.y) : 0;
        ring.push_back({p.x + dx + between(-2, 2), p.y + dy + between(-2, 2)});
      };
      const int left = x * kWidth;
      const int top = y * kWidth;
      for (int i = 0; i < kWidth; i += 30) add({left + i, top});
      for (int i = 0; i < kWidth; i += 30) add({left + kWidth, top + i});
      for (int i = 0; i < kWidth; i += 30) add({left + kWidth - i, top + kWidth});
      for (int i = 0; i < kWidth; i += 30) add({left, top + kWidth - i});
      features.emplace_back().add(ring);
      clean_rings(features.back());
    }
  }
  return features;
}

TEST(GapClosing, CarelesslyDrawnNeighboursBecomeACoverage) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::vector<Rings> drawn = carelessly_drawn(seed);
    const CoverageOutcome before = Closing(drawn, 1e-6).build();
    ASSERT_GT(before.gaps, 20u);
    ASSERT_GT(before.overlaps.size(), 10u);
    const Closing c(drawn, 12);
    const CoverageOutcome after = c.build(12);
    EXPECT_EQ(after.gaps, 0u);
    double overlaps = 0;
    for (const Overlap& overlap : after.overlaps) overlaps += overlap.area;
    double overlaps_before = 0;
    for (const Overlap& overlap : before.overlaps) overlaps_before += overlap.area;
    EXPECT_LT(overlaps, 0.05 * overlaps_before);
    // Twelve inner borders of ten edges either way; a missing vertex costs at most one.
    EXPECT_GT(after.shared_edges, 200u);
  }
}

TEST(GapClosing, ResultDoesNotHangOnHowRingsAreWritten) {
  std::vector<Rings> drawn = carelessly_drawn(7);
  const Closing c(drawn, 12);
  for (Rings& rings : drawn) std::reverse(rings.points.begin(), rings.points.end());
  const Closing reversed(drawn, 12);
  TrapezoidalGraph a;
  TrapezoidalGraph b;
  c.build(12, a);
  reversed.build(12, b);
  EXPECT_EQ(plain_trapezoids(a), plain_trapezoids(b));
}

}  // namespace
}  // namespace trapeze
