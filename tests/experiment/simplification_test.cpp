#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "bench/experiment/blg_tree.h"
#include "bench/experiment/douglas_peucker.h"
#include "core/adapt/vertex_weight.h"
#include "tests/experiment/sample_map.h"

namespace trapeze::experiment {
namespace {

constexpr unsigned kSimplifiedShapes = 210;
constexpr double kTolerances[] = {0, 0.5, 3, 20, 150, 5000, 1e9};

std::vector<std::uint32_t> kept_vertices(RingSimplifier& simplifier, std::uint32_t ring,
                                         double epsilon) {
  std::vector<Chain> chains;
  simplifier.simplify(ring, epsilon, chains);
  std::vector<std::uint32_t> kept;
  for (const Chain& chain : chains) kept.push_back(chain.begin);
  return kept;
}

TEST(DouglasPeucker, KeepsTheVerticesWhoseWeightInTheCoreIsTheToleranceOrMore) {
  VertexWeights weights;
  for (const PolygonSet& set : random_polygon_sets(kSimplifiedShapes)) {
    DouglasPeucker simplifier(set);
    for (std::uint32_t ring = 0; ring < set.rings.size(); ++ring) {
      const auto weight = weights.weigh(set.rings[ring], WeightRule::douglas_peucker);
      for (const double epsilon : kTolerances) {
        std::vector<std::uint32_t> expected;
        for (std::uint32_t i = 0; i < weight.size(); ++i) {
          if (weight[i] >= epsilon) expected.push_back(i);
        }
        ASSERT_EQ(kept_vertices(simplifier, ring, epsilon), expected) << "tolerance " << epsilon;
      }
    }
  }
}

TEST(BlgTrees, KeepWhatDouglasPeuckerKeeps) {
  for (const PolygonSet& set : random_polygon_sets(kSimplifiedShapes)) {
    DouglasPeucker douglas_peucker(set);
    BlgTrees trees(set);
    for (std::uint32_t ring = 0; ring < set.rings.size(); ++ring) {
      for (const double epsilon : kTolerances) {
        ASSERT_EQ(kept_vertices(trees, ring, epsilon),
                  kept_vertices(douglas_peucker, ring, epsilon))
            << "tolerance " << epsilon;
      }
    }
  }
}

TEST(Chains, AreSplitWhereTheyAreFarthestFromTheirChord) {
  for (const PolygonSet& set : random_polygon_sets(kSimplifiedShapes)) {
    DouglasPeucker douglas_peucker(set);
    BlgTrees trees(set);
    std::vector<Chain> chains;
    for (std::uint32_t ring = 0; ring < set.rings.size(); ++ring) {
      trees.simplify(ring, 50, chains);
      for (const Chain& chain : chains) {
        if (!chain.has_dropped()) continue;
        const auto [before, after] = trees.split(ring, chain);
        const auto [dp_before, dp_after] = douglas_peucker.split(ring, chain);
        EXPECT_EQ(before.end, chain.split);
        EXPECT_EQ(after.begin, chain.split);
        EXPECT_EQ(before.split, dp_before.split);
        EXPECT_EQ(after.split, dp_after.split);
        EXPECT_EQ(before.distance, dp_before.distance);
        EXPECT_EQ(after.distance, dp_after.distance);
      }
      chains.clear();
    }
  }
}

}  // namespace
}  // namespace trapeze::experiment
