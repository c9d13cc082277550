// Polygons that share borders: their graph, its removals, and its history.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "core/adapt/adaptable_graph.h"
#include "core/adapt/history_recorder.h"
#include "core/borders/coverage_builder.h"
#include "core/graph/check_graph.h"
#include "core/grid/ring_box.h"
#include "tests/core/borders/coverage_shapes.h"
#include "tests/core/shapes/drawn_trapezoids.h"
#include "tests/sanitized.h"

namespace trapeze {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr unsigned kShapes = testing::kIsSanitized ? 60 : 160;

using Texts = std::vector<std::string>;

std::vector<Rings> features_from_text(const Texts& texts) {
  std::vector<Rings> features;
  for (const std::string& text : texts) features.push_back(rings_from_text(text));
  return features;
}

struct BuiltCoverage {
  CoverageOutcome outcome;
  TrapezoidalGraph graph;

  explicit BuiltCoverage(const std::vector<Rings>& features,
                         double narrowest_overlap = kUnlimited) {
    const CoverageTolerance tolerance{.most_overlap = kUnlimited,
                                      .narrowest_overlap = narrowest_overlap};
    outcome = CoverageBuilder().build(pointers_to(features), tolerance, graph);
    EXPECT_EQ(outcome.failure, "");
    if (!outcome.built) return;
    EXPECT_EQ(check_graph(graph), "");
  }
  explicit BuiltCoverage(const Texts& texts) : BuiltCoverage(features_from_text(texts)) {}

  std::int64_t doubled_area(FaceId face) const {
    return static_cast<std::int64_t>(graph.doubled_areas()[face]);
  }
};

TEST(Coverage, BorderOfTwoSquaresIsThereOnce) {
  const BuiltCoverage c(Texts{"0 0, 10 0, 10 10, 0 10", "10 0, 20 0, 20 10, 10 10"});
  ASSERT_TRUE(c.outcome.built);
  EXPECT_FALSE(c.outcome.noded);
  EXPECT_EQ(c.outcome.vertices, 6u);
  EXPECT_EQ(c.outcome.shared_edges, 1u);
  EXPECT_EQ(c.outcome.junctions, 2u);
  EXPECT_EQ(c.doubled_area(1), 200);
  EXPECT_EQ(c.doubled_area(2), 200);
  EXPECT_TRUE(c.outcome.overlaps.empty());
}

TEST(Coverage, MissingVertexOfOneSideIsPutIn) {
  const BuiltCoverage c(Texts{"0 0, 10 0, 10 10, 0 10", "10 0, 20 0, 20 10, 10 10, 10 5"});
  ASSERT_TRUE(c.outcome.built);
  EXPECT_TRUE(c.outcome.noded);
  EXPECT_EQ(c.outcome.shared_edges, 2u);
  EXPECT_EQ(c.outcome.vertices, 7u);
}

TEST(Coverage, LastFeatureHasThePlaceWhereTwoOverlap) {
  const BuiltCoverage c(Texts{"0 0, 12 0, 12 10, 0 10", "10 0, 20 0, 20 10, 10 10"});
  ASSERT_TRUE(c.outcome.built);
  EXPECT_EQ(c.doubled_area(1), 200);
  EXPECT_EQ(c.doubled_area(2), 200);
  ASSERT_EQ(c.outcome.overlaps.size(), 1u);
  EXPECT_EQ(c.outcome.overlaps[0].lower, 0u);
  EXPECT_EQ(c.outcome.overlaps[0].upper, 1u);
  EXPECT_DOUBLE_EQ(c.outcome.overlaps[0].area, 20);
  EXPECT_DOUBLE_EQ(c.outcome.areas[0], 120);
  EXPECT_DOUBLE_EQ(c.outcome.areas[1], 100);
}

TEST(Coverage, FeatureUnderAnotherHasNoPlaceLeft) {
  const BuiltCoverage c(Texts{"2 2, 8 2, 8 8, 2 8", "0 0, 10 0, 10 10, 0 10"});
  ASSERT_TRUE(c.outcome.built);
  EXPECT_EQ(c.doubled_area(1), 0);
  EXPECT_EQ(c.doubled_area(2), 200);
  EXPECT_EQ(c.outcome.vertices, 4u);
}

TEST(Coverage, EnclaveAndGapNeedNothingSpecial) {
  const BuiltCoverage c(Texts{"0 0, 30 0, 30 30, 0 30; 10 10, 20 10, 20 20, 10 20",
                              "10 10, 20 10, 20 20, 10 20; 12 12, 18 12, 18 18, 12 18"});
  ASSERT_TRUE(c.outcome.built);
  EXPECT_EQ(c.outcome.junctions, 0u);
  EXPECT_EQ(c.outcome.gaps, 0u);
  EXPECT_EQ(c.doubled_area(2), 200 - 72);
}

TEST(Coverage, HoleWithTwoFeaturesAroundItIsAGap) {
  const BuiltCoverage c(Texts{"0 0, 10 0, 10 4, 9 5, 10 6, 10 10, 0 10",
                              "10 0, 20 0, 20 10, 10 10, 10 6, 11 5, 10 4"});
  ASSERT_TRUE(c.outcome.built);
  EXPECT_EQ(c.outcome.gaps, 1u);
  EXPECT_EQ(c.outcome.junctions, 4u);
}

TEST(Coverage, FeaturesThatCoverNothingAreNotBuilt) {
  EXPECT_FALSE(BuiltCoverage(std::vector<Rings>(3)).outcome.built);
  const BuiltCoverage twice(Texts{"0 0, 10 0, 10 10; 0 0, 10 0, 10 10", ""});
  EXPECT_FALSE(twice.outcome.built);
}

TEST(Coverage, RingsOfFacesAreThoseThatItWasBuiltFrom) {
  for (unsigned seed = 0; seed < kShapes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const BuiltCoverage c(random_coverage(seed));
    if (!c.outcome.built) continue;
    const BuiltCoverage again(rings_of_faces(c.graph));
    ASSERT_TRUE(again.outcome.built);
    EXPECT_FALSE(again.outcome.noded);
    EXPECT_TRUE(again.outcome.overlaps.empty());
    EXPECT_EQ(plain_trapezoids(again.graph), plain_trapezoids(c.graph));
  }
}

/// A map rebuilt from the remaining faces equals the current one.
void expect_map_of_what_is_left(const TrapezoidalGraph& graph) {
  const std::vector<Rings> rings = rings_of_faces(graph);
  TrapezoidalGraph fresh;
  const CoverageOutcome outcome =
      CoverageBuilder().build(pointers_to(rings), {.most_overlap = kUnlimited}, fresh);
  EXPECT_FALSE(outcome.noded) << "the borders that are left cross or touch";
  if (!outcome.built) {
    EXPECT_EQ(graph.inside_nodes().size(), 0u);
    return;
  }
  EXPECT_TRUE(outcome.overlaps.empty());
  EXPECT_EQ(plain_trapezoids(graph), plain_trapezoids(fresh));
}

TEST(Coverage, EveryRemovalLeavesTheMapOfTheFacesThatAreLeft) {
  std::size_t regions = 0;
  for (unsigned seed = 0; seed < kShapes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    BuiltCoverage c(random_coverage(seed));
    if (!c.outcome.built) continue;
    EditLog log(c.graph);
    PriorityStack stack;
    stack.assign(c.graph, {});
    while (stack.remove_next(c.graph, log)) {
      regions += stack.last_removal() == Removal::region;
      ASSERT_EQ(check_graph(c.graph), "") << "after " << log.size() << " removals";
      expect_map_of_what_is_left(c.graph);
      if (::testing::Test::HasFailure()) FAIL() << "after " << log.size() << " removals";
    }
    EXPECT_EQ(c.graph.inside_nodes().size(), 0u) << "something never goes";
  }
  EXPECT_GT(regions, kShapes);
}

TEST(Coverage, StateDependsOnTheToleranceOnly) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const BuiltCoverage c(random_coverage(seed));
    if (!c.outcome.built) continue;
    AdaptableGraph wandering(c.graph);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> exponent(-2, 16);
    for (int jump = 0; jump < 30; ++jump) {
      const double epsilon = jump % 7 == 6 ? 0 : std::exp2(exponent(random));
      wandering.adapt_to(epsilon);
      AdaptableGraph direct(c.graph);
      direct.adapt_to(epsilon);
      ASSERT_EQ(wandering.graph(), direct.graph()) << "at " << epsilon;
    }
    wandering.adapt_to(kUnlimited);
    wandering.adapt_to(0);
    EXPECT_EQ(wandering.graph(), c.graph);
  }
}

std::vector<std::uint32_t> rows_for(const TrapezoidalGraph& graph) {
  std::vector<std::uint32_t> rows;
  for (FaceId face = 1; face <= graph.face_count(); ++face) rows.push_back(10 * face);
  return rows;
}

TEST(Coverage, LifespansGiveTheTrapezoidsOfAdaptingAtEveryLevel) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    BuiltCoverage c(random_coverage(seed));
    if (!c.outcome.built) continue;
    const std::vector<std::uint32_t> rows = rows_for(c.graph);
    AdaptableGraph adaptable(c.graph);
    History history;
    HistoryRecorder().record(c.graph, rows, {}, history);
    for (int level = 0; level <= kLastLevel; ++level) {
      adaptable.adapt_to(epsilon_of_level(static_cast<Level>(level)));
      ASSERT_EQ(alive_at(history, static_cast<Level>(level)), inside_of(adaptable.graph(), rows))
          << "level " << level;
    }
  }
}

TEST(Coverage, RegionAtTheCoastGoesToALandHoweverLongTheCoast) {
  // A spit with three sides in the sea, between two countries; its width equals the tolerance.
  BuiltCoverage c(Texts{"0 0, 1000 0, 1000 400, 0 400", "1000 198, 1100 198, 1100 202, 1000 202",
                        "1000 0, 1400 0, 1400 198, 1100 198, 1000 198"});
  ASSERT_TRUE(c.outcome.built);
  AdaptableGraph adaptable(c.graph);
  adaptable.adapt_to(3);
  const TrapezoidalGraph& graph = adaptable.graph();
  EXPECT_EQ(check_graph(graph), "");
  const std::vector<Int128> areas = graph.doubled_areas();
  EXPECT_EQ(static_cast<std::int64_t>(areas[2]), 0);
  EXPECT_EQ(static_cast<std::int64_t>(areas[1] + areas[3]),
            static_cast<std::int64_t>(c.graph.doubled_area()))
      << "what is all around has not changed";
}

TEST(Coverage, ACornerThatASmallNeighbourHadStaysWhenThatIsTaken) {
  // The corner of the large square is itself a small square, which becomes a part of it. All
  // vertices there are close to each other, so that each could be removed if the others stayed.
  const BuiltCoverage c(
      Texts{"40 0, 1000 0, 1000 1000, 0 1000, 0 40, 40 40", "0 0, 40 0, 40 40, 0 40"});
  ASSERT_TRUE(c.outcome.built);
  AdaptableGraph adaptable(c.graph);
  for (const double tolerance : {25.0, 35.0, 50.0, 100.0, 300.0}) {
    adaptable.adapt_to(tolerance);
    EXPECT_NEAR(static_cast<double>(adaptable.graph().doubled_areas()[1]) / 2, 1e6, tolerance * 100)
        << tolerance;
  }
}

TEST(Coverage, WhatIsLostByOneFeatureIsLessOfTheOneThatTookIt) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    BuiltCoverage c(random_coverage(seed));
    if (!c.outcome.built) continue;
    const std::vector<Int128> areas = c.graph.doubled_areas();
    History history;
    const std::vector<std::uint32_t> rows = rows_for(c.graph);
    HistoryRecorder().record(c.graph, rows, {}, history);
    // In the end everything is dust, and the dust of each feature equals its original area.
    std::vector<double> dust(rows.size(), 0);
    for (const Grain& grain : history.grains) {
      dust[grain.row / 10 - 1] += grain.area;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double area = static_cast<double>(areas[i + 1]) / 2;
      EXPECT_NEAR(dust[i], area, 1e-6 * (1 + area)) << "feature " << i;
    }
  }
}

// Features that share faces.

constexpr double kNone = 0;  // narrower overlaps get no face of their own

TEST(CoverageInCommon, APlaceOfTwoFeaturesIsAFaceIfItIsWide) {
  const Texts texts{"0 0, 12 0, 12 10, 0 10", "10 0, 20 0, 20 10, 10 10"};
  // 2 x 10 cells: the mean width is 20 / 12.
  const BuiltCoverage wide(features_from_text(texts), 1.6);
  ASSERT_EQ(wide.outcome.faces.face_count(), 3u);
  EXPECT_THAT(wide.outcome.faces.of(3), ::testing::ElementsAre(0, 1));
  EXPECT_EQ(wide.doubled_area(1), 200);
  EXPECT_EQ(wide.doubled_area(2), 160);
  EXPECT_EQ(wide.doubled_area(3), 40);
  EXPECT_EQ(wide.outcome.shared_edges, 0u) << "both go on beyond each of them";
  const BuiltCoverage narrow(features_from_text(texts), 1.7);
  EXPECT_EQ(narrow.outcome.faces.face_count(), 2u);
  EXPECT_EQ(narrow.doubled_area(2), 200);
}

TEST(CoverageInCommon, AWidePlaceIsAFaceHoweverManyNarrowOnesThereAre) {
  // Along a border that is 400 cells long, the second feature is over the first one by one cell;
  // farther up they overlap by 20 x 20 cells.
  const Texts texts{"0 0, 101 0, 101 400, 100 400, 100 420, 120 420, 120 440, 0 440",
                    "100 0, 200 0, 200 440, 100 440, 100 420, 105 420, 105 400, 100 400"};
  const BuiltCoverage c(features_from_text(texts), 5);
  ASSERT_EQ(c.outcome.overlaps.size(), 1u);
  EXPECT_DOUBLE_EQ(c.outcome.overlaps[0].area, 400 + 400);
  ASSERT_EQ(c.outcome.faces.face_count(), 3u);
  EXPECT_THAT(c.outcome.faces.of(3), ::testing::ElementsAre(0, 1));
  EXPECT_EQ(c.doubled_area(3), 2 * 400);
  EXPECT_EQ(c.doubled_area(1), 2 * (440 * 100));
  const BuiltCoverage narrow(features_from_text(texts), 10.1);
  EXPECT_EQ(narrow.outcome.faces.face_count(), 2u);
}

TEST(CoverageInCommon, AFeatureLeftOutDoesNotDivideAPlace) {
  // Two features overlap by 10 x 100 cells. The third one overlaps both, up to their middle.
  const Texts texts{"0 0, 110 0, 110 100, 0 100", "100 0, 200 0, 200 100, 100 100",
                    "40 0, 160 0, 160 50, 40 50"};
  TrapezoidalGraph graph;
  const std::vector<Rings> features = features_from_text(texts);
  const CoverageOutcome outcome = CoverageBuilder().build(
      pointers_to(features), {.most_overlap = 0.2, .narrowest_overlap = 9}, graph);
  EXPECT_THAT(outcome.apart, ::testing::ElementsAre(2));
  // The mean width of each half is 500 / 60, of both together 1000 / 110.
  EXPECT_THAT(outcome.faces.shared(), ::testing::ElementsAre(::testing::ElementsAre(0, 1)));
}

TEST(CoverageInCommon, AFeatureWithinAnotherIsNotLost) {
  const BuiltCoverage c(features_from_text({"2 2, 8 2, 8 8, 2 8", "0 0, 10 0, 10 10, 0 10"}),
                        kNone);
  const std::vector<Rings> rings = rings_of_features(c.graph, c.outcome.faces);
  ASSERT_EQ(rings.size(), 2u);
  EXPECT_EQ(rings[0].size(), 1u);
  EXPECT_EQ(rings[0].points.size(), 4u);
  EXPECT_EQ(rings[1].size(), 1u) << "no hole where the other one is";
}

TEST(CoverageInCommon, FeaturesKeepTheirAreas) {
  unsigned shared = 0;
  for (unsigned seed = 0; seed < kShapes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const BuiltCoverage c(random_coverage(seed), kNone);
    if (!c.outcome.built) continue;
    shared += c.outcome.faces.shared().empty() ? 0 : 1;
    const std::vector<Rings> rings = rings_of_features(c.graph, c.outcome.faces);
    const std::vector<const Rings*> pointers = pointers_to(rings);
    const Overlay again = overlay(pointers);
    ASSERT_EQ(again.areas.size(), c.outcome.areas.size());
    for (std::size_t i = 0; i < rings.size(); ++i) {
      EXPECT_DOUBLE_EQ(again.areas[i], c.outcome.areas[i]) << "feature " << i;
    }
  }
  EXPECT_GT(shared, kShapes / 8);
}

TEST(CoverageInCommon, RingsOfFeaturesDoNotCross) {
  unsigned touching = 0;
  for (unsigned seed = 0; seed < kShapes; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const BuiltCoverage c(random_coverage(seed), kNone);
    if (!c.outcome.built) continue;
    for (const Rings& rings : rings_of_features(c.graph, c.outcome.faces)) {
      for (std::size_t i = 0; i < rings.size(); ++i) {
        const std::span<const Point> ring = rings[i];
        std::set<std::pair<std::int32_t, std::int32_t>> places;
        for (const Point p : ring) places.emplace(p.x, p.y);
        if (places.size() == ring.size()) continue;
        ++touching;
        Rings alone;
        alone.add(ring);
        // Where it crossed itself, parts would cancel each other out.
        const std::array<const Rings*, 1> features = {&alone};
        EXPECT_DOUBLE_EQ(overlay(features).areas.at(0), area_of_ring(ring)) << "ring " << i;
      }
    }
  }
  EXPECT_GT(touching, 0u);
}

/// Calls check(history, level, adapted graph, faces) for every level of the coverages of the first
/// seeds whose features overlap, until a check fails.
template <typename Check>
void for_each_level_in_common(unsigned seeds, const Check& check) {
  for (unsigned seed = 0; seed < seeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    BuiltCoverage c(random_coverage(seed), kNone);
    if (!c.outcome.built || c.outcome.faces.shared().empty()) continue;
    AdaptableGraph adaptable(c.graph);
    History history;
    HistoryRecorder().record(c.graph, c.outcome.faces, {}, history);
    for (int level = 0; level <= kLastLevel; ++level) {
      adaptable.adapt_to(epsilon_of_level(static_cast<Level>(level)));
      ASSERT_NO_FATAL_FAILURE(
          check(history, static_cast<Level>(level), adaptable.graph(), c.outcome.faces));
    }
  }
}

TEST(CoverageInCommon, LifespansGiveTheTrapezoidsOfAllFeaturesAtEveryLevel) {
  for_each_level_in_common(200, [](const History& history, Level level,
                                   const TrapezoidalGraph& graph, const FaceFeatures& faces) {
    ASSERT_EQ(alive_at(history, level), inside_of(graph, faces)) << "level " << int{level};
  });
}

TEST(CoverageInCommon, AllOfAFeatureIsDustInTheEnd) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    BuiltCoverage c(random_coverage(seed), kNone);
    if (!c.outcome.built || c.outcome.faces.shared().empty()) continue;
    const double covered = static_cast<double>(c.graph.doubled_area()) / 2;
    History history;
    HistoryRecorder().record(c.graph, c.outcome.faces, {}, history);
    std::vector<double> dust(c.outcome.areas.size(), 0);
    double together = 0;
    for (const Grain& grain : history.grains) {
      dust[grain.row] += grain.area;
      if (!grain.is_covered) together += grain.area;
    }
    EXPECT_NEAR(together, covered, 1e-6 * (1 + covered));
    for (std::size_t i = 0; i < dust.size(); ++i) {
      const double area = c.outcome.areas[i];
      EXPECT_NEAR(dust[i], area, 1e-6 * (1 + area)) << "feature " << i;
    }
  }
}

// Includes horizontal borders, along which nodes have no height.
TEST(CoverageInCommon, LevelEdgesAreThereForThoseWhoseBoundaryTheyAre) {
  BuiltCoverage c(features_from_text({"0 0, 10 0, 10 10, 0 10", "0 5, 10 5, 10 20, 0 20"}), kNone);
  History history;
  HistoryRecorder().record(c.graph, c.outcome.faces, {}, history);
  std::vector<std::pair<std::int32_t, std::uint32_t>> edges;
  for (const HorizontalEdge& edge : history.horizontal_edges) {
    if (edge.lifespan.born > 0) continue;
    edges.emplace_back(history.vertices[history.edges[edge.edge].upper].y, edge.row);
  }
  EXPECT_THAT(edges,
              ::testing::UnorderedElementsAre(::testing::Pair(0, 0), ::testing::Pair(10, 0),
                                              ::testing::Pair(5, 1), ::testing::Pair(20, 1)));
}

/// The row of a feature, and the ends of a level edge of its boundary.
using LevelEdge = std::tuple<std::uint32_t, int, int, int, int>;

std::multiset<LevelEdge> level_edges_of(const TrapezoidalGraph& g, const FaceFeatures& rows) {
  std::multiset<LevelEdge> found;
  for (std::size_t i = 0; i < g.edges().size(); ++i) {
    const Edge& edge = g.edge(EdgeId(i));
    if (!edge.is_alive() || g.is_frame(EdgeId(i))) continue;
    const Point a = g.point(edge.end[kUp]);
    const Point b = g.point(edge.end[kDown]);
    if (a.y != b.y) continue;
    const auto insert = [&](std::uint32_t row) { found.emplace(row, a.x, a.y, b.x, b.y); };
    const auto left = rows.of(edge.face[kLeft]);
    const auto right = rows.of(edge.face[kRight]);
    for_each_apart(left, right, insert);
    for_each_apart(right, left, insert);
  }
  return found;
}

std::multiset<LevelEdge> level_edges_at(const History& h, Level level) {
  std::multiset<LevelEdge> found;
  for (const HorizontalEdge& horizontal_edge : h.horizontal_edges) {
    if (!horizontal_edge.lifespan.contains(level)) continue;
    const MeshEdge& edge = h.edges[horizontal_edge.edge];
    const Point a = h.vertices[edge.upper];
    const Point b = h.vertices[edge.lower];
    found.emplace(horizontal_edge.row, a.x, a.y, b.x, b.y);
  }
  return found;
}

TEST(CoverageInCommon, LifespansGiveTheLevelEdgesOfAllFeaturesAtEveryLevel) {
  std::size_t later_ones = 0;  // not of the first level
  for_each_level_in_common(400, [&](const History& history, Level level,
                                    const TrapezoidalGraph& graph, const FaceFeatures& faces) {
    const auto edges = level_edges_at(history, level);
    if (level > 0) later_ones += edges.size();
    ASSERT_EQ(edges, level_edges_of(graph, faces)) << "level " << int{level};
  });
  EXPECT_GT(later_ones, 1000u);
}

}  // namespace
}  // namespace trapeze
