#include "core/borders/gap_closing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "core/borders/coverage_builder.h"
#include "core/graph/check_graph.h"
#include "core/grid/web_mercator.h"
#include "tests/core/borders/coverage_shapes.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

/// Metres on the ground that equal this many cells near the equator.
double metres_of(double cells) {
  return cells / cells_from_ground(1, 0);
}

using Texts = std::vector<std::string>;

/// Features, and the result of closing their gaps.
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
    return CoverageBuilder().build(pointers,
                                   {.most_overlap = std::numeric_limits<double>::infinity(),
                                    .widest_gap = metres_of(widest_gap_cells)},
                                   graph);
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
  // Nor where both sides have the detail.
  const std::string below = "0 0, 50 0, 51 1, 52 0, 53 1, 100 0, 100 -90, 0 -90";
  const Closing both(Texts{text, below}, 4);
  EXPECT_EQ(both.done.moved + both.done.led, 0u);
  EXPECT_EQ(both.features[1].points, rings_from_text(below).points);
}

TEST(GapClosing, PolygonNarrowerThanTheGapStaysAsItIsAndIsNotCovered) {
  const Texts texts{"0 0, 1000 0, 1000 1000, 0 1000", "1010 0, 1020 0, 1020 1000, 1010 1000",
                    "1030 0, 2000 0, 2000 1000, 1030 1000"};
  const Closing c(texts, 40);
  EXPECT_THAT(c.done.narrow, ElementsAre(1));
  EXPECT_EQ(c.features[1], rings_from_text(texts[1]));
  const CoverageOutcome outcome = c.build();
  EXPECT_EQ(outcome.failure, "");
  EXPECT_TRUE(outcome.overlaps.empty());
}

/// Squares of 100 cells, rotated a little and 50 apart: buildings along streets.
std::vector<Rings> buildings(int columns) {
  std::vector<Rings> features;
  for (int y = 0; y < columns; ++y) {
    for (int x = 0; x < columns; ++x) {
      const Point p{150 * x, 150 * y};
      const int turn = 10 * ((x * 7 + y * 3) % 3);
      features.emplace_back().add(std::vector<Point>{{p.x + turn, p.y},
                                                     {p.x + 100, p.y + turn},
                                                     {p.x + 100 - turn, p.y + 100},
                                                     {p.x, p.y + 100 - turn}});
    }
  }
  return features;
}

TEST(GapClosing, FeaturesOfItsOwnSizeAreLeftAsTheyAre) {
  const std::vector<Rings> drawn = buildings(12);
  const Closing c(drawn, 50);
  EXPECT_EQ(c.done.narrow.size(), drawn.size());
  EXPECT_EQ(c.features, drawn);
}

double length_of(const Rings& rings) {
  double length = 0;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    for (std::size_t i = 0; i < rings[r].size(); ++i) {
      const Point a = rings[r][i];
      const Point b = rings[r][(i + 1) % rings[r].size()];
      length += std::hypot(a.x - b.x, a.y - b.y);
    }
  }
  return length;
}

/// Pieces of a plane that was torn apart. Between the cells of a grid with wiggly borders there are
/// gaps and overlaps of all widths, bays narrower than the distance, and islands in them.
std::vector<Rings> torn(unsigned seed) {
  std::mt19937 random(seed);
  const auto between = [&](int a, int b) {
    return std::uniform_int_distribution<int>(a, b)(random);
  };
  std::vector<Rings> features;
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 5; ++x) {
      const int reach = between(40, 58);
      std::vector<Point> ring;
      for (int i = 0; i < 24; ++i) {
        const double angle = 2 * std::numbers::pi * i / 24;
        const double radius = (between(0, 6) == 0 ? 0.6 : 1) * (reach + between(-4, 4));
        ring.push_back({100 * x + static_cast<int>(radius * std::cos(angle)),
                        100 * y + static_cast<int>(radius * std::sin(angle))});
      }
      features.emplace_back().add(ring);
      clean_rings(features.back());
    }
  }
  return features;
}

TEST(GapClosing, NoFeatureChangesByMoreThanItsBoundaryAndNoneComeToOverlap) {
  std::size_t moved = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::vector<Rings> drawn = torn(seed);
    const double cells = 2 + seed % 14;
    const Closing c(drawn, cells);
    EXPECT_EQ(c.done.failure, "");
    moved += c.done.moved;
    const Overlay before = overlay(pointers_to(drawn));
    const Overlay after = overlay(pointers_to(c.features));
    ASSERT_EQ(before.failure + after.failure, "");
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      EXPECT_LE(std::abs(after.areas[i] - before.areas[i]), length_of(drawn[i]) * cells * 1.001);
      EXPECT_EQ(c.done.drawn[i].empty() ? c.features[i] : c.done.drawn[i], drawn[i]);
    }
    for (const Overlap& overlap : after.overlaps) {
      double known = 0;
      for (const Overlap& earlier : before.overlaps) {
        if (earlier.lower == overlap.lower && earlier.upper == overlap.upper) known = earlier.area;
      }
      EXPECT_LE(overlap.area,
                known + std::min(length_of(drawn[overlap.lower]), length_of(drawn[overlap.upper])));
    }
  }
  EXPECT_GT(moved, 500u) << "so something has been tested";
}

//   ______ ______     The left one is narrow and stays. The middle one keeps its border with
//  |_|    |      |    it, though the right one is near.
//  | |____|______|
TEST(GapClosing, BordersInCommonWithWhatTakesNoPartRemain) {
  const Texts texts{"97 0, 100 0, 100 50, 100 100, 97 100",
                    "100 0, 200 0, 200 100, 100 100, 100 50", "-3 3, 94 3, 94 97, -3 97"};
  const Closing c(texts, 7);
  EXPECT_THAT(c.done.narrow, ElementsAre(0));
  EXPECT_EQ(c.build().shared_edges, 2u);
}

TEST(GapClosing, TooManyVerticesWithinTheDistanceAreRefusedInWords) {
  // Two combs with all teeth within the distance of each other.
  std::vector<Rings> features(2);
  for (int side : {0, 1}) {
    Rings& rings = features[static_cast<std::size_t>(side)];
    const int sign = side == 0 ? -1 : 1;
    for (int i = 0; i < 6000; ++i) rings.points.push_back({sign * (1 + i % 2), 2 * i});
    for (const Point p : {Point{1, 1'000'000}, Point{1'000'000, 1'000'000},
                          Point{1'000'000, -1'000'000}, Point{1, -1'000'000}}) {
      rings.points.push_back({sign * p.x, p.y});
    }
    rings.close_ring();
  }
  const std::vector<Rings> drawn = features;
  const Closing c(features, 13'000);
  EXPECT_EQ(c.done.failure, "too many vertices are that near to each other");
  EXPECT_EQ(c.features, drawn);
}

TEST(GapClosing, NarrowPlaceGoesToNobodyWhoseBorderThereIsShort) {
  // A round gap between many features, each with a small part of its border.
  std::vector<Rings> features;
  const auto at = [](int i, double radius) {
    const double angle = 2 * std::numbers::pi * i / 12;
    return Point{static_cast<int>(radius * std::cos(angle)),
                 static_cast<int>(radius * std::sin(angle))};
  };
  for (int i = 0; i < 12; ++i) {
    features.emplace_back().add(
        std::vector<Point>{at(i, 100), at(i, 1000), at(i + 1, 1000), at(i + 1, 100)});
  }
  // Its mean width is 97 cells.
  const Closing c(features, 0.1);
  EXPECT_EQ(c.build(110).filled, 0u);
  EXPECT_EQ(c.build(600).filled, 1u);
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
  // A lens of 4 cells at its widest, and a narrow hole in the middle of one feature.
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
  // The lens goes to the first of the two features, which have equally long borders with it; the
  // hole is no gap.
  EXPECT_EQ(static_cast<int>(graph.doubled_areas()[1]), 2 * (100 * 100 - 2 * 60) + 120);
}

/// A grid of cells without unassigned area, each digitized separately: vertices do not match those
/// of the neighbour, and some are missing.
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
        // The same neighbours always follow the same intended line.
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

TEST(GapClosing, PlacesOfFeaturesLeftOutAreNotFilled) {
  // Between the two others lies a strip that overlaps the first of them too much to be built with
  // them.
  const std::vector<Rings> features =
      Closing(Texts{"0 0, 50 0, 50 10, 50 20, 45 20, 45 80, 50 80, 50 90, 50 100, 0 100",
                    "100 0, 100 100, 50 100, 50 90, 50 80, 55 80, 55 20, 50 20, 50 10, 50 0",
                    "44 20, 55 20, 55 80, 44 80"},
              0.1)
          .features;
  std::vector<const Rings*> pointers;
  for (const Rings& rings : features) pointers.push_back(&rings);
  TrapezoidalGraph graph;
  const CoverageOutcome outcome =
      CoverageBuilder().build(pointers, {.most_overlap = 0.01, .widest_gap = metres_of(20)}, graph);
  EXPECT_EQ(check_graph(graph), "");
  EXPECT_THAT(outcome.apart, ElementsAre(2u));
  EXPECT_EQ(outcome.filled, 0u);
  EXPECT_EQ(outcome.gaps, 1u);
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
    // Twelve inner borders in each direction, with ten edges each; a missing vertex costs at most
    // one edge.
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
