#include "core/adapt/batch_removal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/adapt/history_recorder.h"
#include "core/borders/coverage_builder.h"
#include "core/sweep/graph_builder.h"
#include "tests/sanitized.h"

namespace trapeze {
namespace {

constexpr unsigned kSeeds = ::trapeze::testing::kIsSanitized ? 1 : 3;

/// The points from a to b, without b. The midpoint is moved sideways, and both halves are divided
/// in the same way.
void add_coast(std::mt19937& random, Point a, Point b, int halvings, std::vector<Point>& points) {
  if (halvings == 0) return points.push_back(a);
  const double by = std::uniform_real_distribution<>(-0.2, 0.2)(random);
  const double dx = static_cast<double>(b.x) - a.x;
  const double dy = static_cast<double>(b.y) - a.y;
  const Point middle = {static_cast<std::int32_t>(std::lround(a.x + dx / 2 - by * dy)),
                        static_cast<std::int32_t>(std::lround(a.y + dy / 2 + by * dx))};
  add_coast(random, a, middle, halvings - 1, points);
  add_coast(random, middle, b, halvings - 1, points);
}

void add_square(std::mt19937& random, Point at, std::int32_t width, int halvings, Rings& rings) {
  const Point corners[] = {
      at, {at.x + width, at.y}, {at.x + width, at.y + width}, {at.x, at.y + width}};
  for (int i = 0; i < 4; ++i) {
    add_coast(random, corners[i], corners[(i + 1) % 4], halvings, rings.points);
  }
  rings.close_ring();
}

/// A land mass with a long coast and lakes, among islands of all sizes.
Rings archipelago(unsigned seed) {
  std::mt19937 random(seed);
  Rings rings;
  add_square(random, {1 << 26, 1 << 26}, 1 << 26, 12, rings);
  std::uniform_int_distribution<std::int32_t> place(0, (1 << 27) + (1 << 26));
  for (int i = 0; i < 1500; ++i) {
    const int size = std::uniform_int_distribution<>(4, 18)(random);
    add_square(random, {place(random), place(random)}, 1 << size,
               std::uniform_int_distribution<>(0, 3)(random), rings);
  }
  return rings;
}

/// Land masses that share borders, one of them around islands.
std::vector<Rings> lands(unsigned seed) {
  constexpr int kAcross = 4;
  constexpr int kHalvings = 10;
  constexpr std::int32_t kWidth = 1 << 24;
  std::mt19937 random(seed);
  std::vector<Point> across[kAcross + 1][kAcross];
  std::vector<Point> down[kAcross + 1][kAcross];
  for (int i = 0; i <= kAcross; ++i) {
    for (int k = 0; k < kAcross; ++k) {
      add_coast(random, {k * kWidth, i * kWidth}, {(k + 1) * kWidth, i * kWidth}, kHalvings,
                across[i][k]);
      across[i][k].push_back({(k + 1) * kWidth, i * kWidth});
      add_coast(random, {i * kWidth, k * kWidth}, {i * kWidth, (k + 1) * kWidth}, kHalvings,
                down[i][k]);
      down[i][k].push_back({i * kWidth, (k + 1) * kWidth});
    }
  }
  std::vector<Rings> lands;
  for (int row = 0; row < kAcross; ++row) {
    for (int column = 0; column < kAcross; ++column) {
      Rings& rings = lands.emplace_back();
      const auto add = [&rings](auto begin, auto end) {
        rings.points.insert(rings.points.end(), begin, end - 1);
      };
      add(across[row][column].begin(), across[row][column].end());
      add(down[column + 1][row].begin(), down[column + 1][row].end());
      add(across[row + 1][column].rbegin(), across[row + 1][column].rend());
      add(down[column][row].rbegin(), down[column][row].rend());
      rings.close_ring();
    }
  }
  std::uniform_int_distribution<std::int32_t> place(0, kAcross * kWidth);
  for (int i = 0; i < 400; ++i) {
    add_square(random, {-place(random) - (1 << 20), place(random)},
               1 << std::uniform_int_distribution<>(6, 18)(random), 2, lands.front());
  }
  return lands;
}

struct Recorded {
  History history;
  PriorityStack::Counts counts;
};

void expect_same(const Recorded& one, const Recorded& other) {
  EXPECT_EQ(one.counts.removals, other.counts.removals);
  EXPECT_EQ(one.counts.tests, other.counts.tests);
  EXPECT_EQ(one.counts.walked, other.counts.walked);
  EXPECT_EQ(one.counts.touched, other.counts.touched);
  const History& a = one.history;
  const History& b = other.history;
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.loop_sizes, b.loop_sizes);
  EXPECT_EQ(a.trapezoids, b.trapezoids);
  EXPECT_EQ(a.lifespans, b.lifespans);
  EXPECT_EQ(a.rows, b.rows);
  const auto is_same_edge = [](const MeshEdge& x, const MeshEdge& y) {
    return x.upper == y.upper && x.lower == y.lower;
  };
  EXPECT_TRUE(std::ranges::equal(a.edges, b.edges, is_same_edge));
  const auto is_same_note = [](const MilestoneNote& x, const MilestoneNote& y) {
    return x.vertex == y.vertex && x.milestone == y.milestone && x.level == y.level;
  };
  EXPECT_TRUE(std::ranges::equal(a.milestones, b.milestones, is_same_note));
  const auto is_same_horizontal = [](const HorizontalEdge& x, const HorizontalEdge& y) {
    return x.edge == y.edge && x.lifespan == y.lifespan && x.row == y.row && x.is_copy == y.is_copy;
  };
  EXPECT_TRUE(std::ranges::equal(a.horizontal_edges, b.horizontal_edges, is_same_horizontal));
  const auto is_same_grain = [](const Grain& x, const Grain& y) {
    return x.axis.from == y.axis.from && x.axis.to == y.axis.to && x.area == y.area &&
           x.born == y.born && x.row == y.row && x.is_covered == y.is_covered;
  };
  EXPECT_TRUE(std::ranges::equal(a.grains, b.grains, is_same_grain));
}

Recorded record_archipelago(unsigned seed, const GeneralizationOptions& options, unsigned threads) {
  Rings rings = archipelago(seed);
  GraphBuilder builder;
  TrapezoidalGraph graph;
  EXPECT_TRUE(builder.build(rings, graph).built);
  Recorded recorded;
  HistoryRecorder recorder;
  recorder.record(graph, FaceFeatures({0}), options, recorded.history, nullptr, threads);
  recorded.counts = recorder.stack().counts();
  return recorded;
}

TEST(BatchRemoval, ResultIsThatOfOneAfterAnother) {
  constexpr GeneralizationOptions kOptions[] = {
      {WeightRule::douglas_peucker, Topology::strict},
      {WeightRule::douglas_peucker, Topology::fast},
      {WeightRule::shape, Topology::strict},
  };
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    for (const GeneralizationOptions& options : kOptions) {
      const Recorded one = record_archipelago(seed, options, 1);
      EXPECT_EQ(one.counts.at_once, 0u);
      for (const unsigned threads : {2u, 5u}) {
        SCOPED_TRACE("seed " + std::to_string(seed) + " by " + std::to_string(threads));
        const Recorded other = record_archipelago(seed, options, threads);
        EXPECT_GT(other.counts.at_once, other.counts.removals / 5);
        expect_same(one, other);
      }
    }
  }
}

Recorded record_lands(unsigned seed, unsigned threads) {
  const std::vector<Rings> features = lands(seed);
  std::vector<const Rings*> all;
  for (const Rings& rings : features) all.push_back(&rings);
  CoverageBuilder builder;
  TrapezoidalGraph graph;
  const CoverageOutcome outcome = builder.build(all, {}, graph);
  EXPECT_TRUE(outcome.built) << outcome.failure;
  Recorded recorded;
  HistoryRecorder recorder;
  recorder.record(graph, outcome.faces, {}, recorded.history, nullptr, threads);
  recorded.counts = recorder.stack().counts();
  return recorded;
}

TEST(BatchRemoval, ResultIsThatOfOneAfterAnotherWhereBordersAreShared) {
  for (unsigned seed = 0; seed < 2 * kSeeds; ++seed) {
    const Recorded one = record_lands(seed, 1);
    for (const unsigned threads : {2u, 5u}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " by " + std::to_string(threads));
      const Recorded other = record_lands(seed, threads);
      EXPECT_GT(other.counts.at_once, other.counts.removals / 6);
      expect_same(one, other);
    }
  }
}

}  // namespace
}  // namespace trapeze
