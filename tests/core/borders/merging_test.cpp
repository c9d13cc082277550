// What lies near each other becomes one block.
#include "core/borders/merging.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include "core/adapt/adaptable_graph.h"
#include "core/adapt/history.h"
#include "core/borders/coverage_builder.h"
#include "core/graph/check_graph.h"
#include "core/sweep/clean_rings.h"
#include "tests/core/shapes/drawn_trapezoids.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {
namespace {

constexpr double kAll = std::numeric_limits<double>::infinity();

/// Houses of random sizes and shapes on both sides of streets, turned by an angle.
std::vector<Rings> town(unsigned seed, int houses, double angle = 0) {
  std::mt19937 random(seed);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  std::vector<Rings> features;
  const int columns = std::max(1, static_cast<int>(std::sqrt(houses)));
  const double cos = std::cos(angle);
  const double sin = std::sin(angle);
  for (int i = 0; i < houses; ++i) {
    const double x = (i % columns) * 2000.0 + between(0, 300);
    const double y = (i / columns) * 2000.0 + between(0, 300);
    const double w = between(600, 1900);
    const double h = between(600, 1900);
    std::vector<std::pair<double, double>> shape = {{0, 0}, {w, 0}, {w, h}, {0, h}};
    const double kind = between(0, 3);
    if (kind < 1) shape = {{0, 0}, {w, 0}, {w, h / 2}, {w / 2, h / 2}, {w / 2, h}, {0, h}};
    const double turn = between(-0.3, 0.3);
    Rings rings;
    const auto add = [&](const std::vector<std::pair<double, double>>& points) {
      std::vector<Point> ring;
      for (const auto& [px, py] : points) {
        const double qx = x + px * std::cos(turn) - py * std::sin(turn);
        const double qy = y + px * std::sin(turn) + py * std::cos(turn);
        ring.push_back({static_cast<std::int32_t>(std::lround(qx * cos - qy * sin)),
                        static_cast<std::int32_t>(std::lround(qx * sin + qy * cos))});
      }
      rings.add(ring);
    };
    add(shape);
    if (kind > 2) {
      add({{w / 4, h / 4}, {w / 2, h / 4}, {w / 2, h / 2}, {w / 4, h / 2}});
    }
    clean_rings(rings);
    features.push_back(std::move(rings));
  }
  return features;
}

struct BuiltTown {
  CoverageOutcome outcome;
  TrapezoidalGraph graph;

  explicit BuiltTown(const std::vector<Rings>& features, const Merging& merging) {
    std::vector<const Rings*> pointers;
    for (const Rings& rings : features) pointers.push_back(&rings);
    const CoverageTolerance tolerance{.most_overlap = kAll, .narrowest_overlap = 32};
    outcome = CoverageBuilder().build(pointers, tolerance, graph, nullptr, 1, merging);
    EXPECT_EQ(outcome.failure, "");
    EXPECT_EQ(check_graph(graph), "");
  }
};

TEST(Merging, EveryStepLeavesASoundGraph) {
  for (unsigned seed = 0; seed < 24; ++seed) {
    SCOPED_TRACE(seed);
    const BuiltTown built(town(seed, 3 + static_cast<int>(seed) * 2),
                          {.ratio = 4 + seed % 3 * 6.0});
    ASSERT_TRUE(built.outcome.plan);
    TrapezoidalGraph graph = built.graph;
    EditLog log(graph);
    PriorityStack stack;
    stack.assign(graph, {}, 1, &*built.outcome.plan);
    int step = 0;
    while (stack.remove_next(graph, log)) {
      const std::string wrong = check_graph(graph);
      ASSERT_EQ(wrong, "") << "step " << step;
      ++step;
    }
    EXPECT_GT(step, 10);
    while (log.applied() > 0) log.revert();
    EXPECT_TRUE(graph == built.graph);
  }
}

}  // namespace
}  // namespace trapeze
