#include "bench/core/polygon_families.h"

#include <gtest/gtest.h>

#include <string>

#include "core/graph/check_graph.h"
#include "core/sweep/graph_builder.h"

namespace trapeze {
namespace {

void expect_whole(Rings rings) {
  TrapezoidalGraph graph;
  const BuildOutcome outcome = GraphBuilder().build(rings, graph);
  ASSERT_TRUE(outcome.built);
  EXPECT_FALSE(outcome.noded);
  EXPECT_EQ(outcome.collapsed_rings, 0u);
  EXPECT_EQ(check_graph(graph), "");
}

TEST(PolygonFamilies, NeitherCrossNorTouchAtAnySize) {
  for (const PolygonFamily& family : kPolygonFamilies) {
    for (const std::size_t vertices : {20u, 100u, 1000u, 20000u}) {
      SCOPED_TRACE(std::string(family.name) + " of " + std::to_string(vertices));
      expect_whole(family.make(vertices));
    }
  }
}

TEST(PolygonFamilies, HaveAboutTheVerticesAskedFor) {
  for (const PolygonFamily& family : kPolygonFamilies) {
    const auto vertices = static_cast<double>(family.make(10000).points.size());
    EXPECT_NEAR(vertices, 10000, 500) << family.name;
  }
}

TEST(PolygonFamilies, BuildingsAreWholeInAnyDirection) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_whole(building(seed));
  }
}

}  // namespace
}  // namespace trapeze
