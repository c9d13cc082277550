#include "bench/experiment/triangulation.h"

#include <gtest/gtest.h>

#include "core/sweep/graph_builder.h"
#include "tests/experiment/sample_map.h"

namespace trapeze::experiment {
namespace {

double area_of(const TrapezoidList& trapezoids) {
  double area = 0;
  for (const TrapezoidRecord& t : trapezoids.records) {
    const auto width = [&](std::int32_t y) {
      return x_at(t.right_upper, t.right_lower, y) - x_at(t.left_upper, t.left_lower, y);
    };
    area += (width(t.top) + width(t.bottom)) / 2 * (static_cast<double>(t.bottom) - t.top);
  }
  return area;
}

TEST(TrapezoidList, CutsATriangleAtItsMiddleVertex) {
  TrapezoidList list;
  list.append_triangle({{{0, 10}, {10, 4}, {2, 0}}}, kEverything);
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list.records[0], (TrapezoidRecord{0, 4, {2, 0}, {0, 10}, {2, 0}, {10, 4}}));
  EXPECT_EQ(list.records[1], (TrapezoidRecord{4, 10, {2, 0}, {0, 10}, {10, 4}, {0, 10}}));
  EXPECT_EQ(area_of(list), 44);
  list.append_triangle({{{0, 0}, {4, 0}, {0, 4}}}, kEverything);
  EXPECT_EQ(list.size(), 3u) << "one part has no height";
  list.append_triangle({{{0, 0}, {4, 4}, {8, 8}}}, kEverything);
  EXPECT_EQ(list.size(), 3u) << "no area";
  list.append_triangle({{{0, 0}, {4, 1}, {2, 4}}}, {100, 100, 200, 200});
  EXPECT_EQ(list.size(), 3u) << "beyond the view";
}

TEST(Triangulation, CoversThePolygons) {
  if (!has_triangulation()) GTEST_SKIP() << "built without CGAL";
  Triangulation triangulation;
  for (const PolygonSet& set : random_polygon_sets(210)) {
    for (std::size_t p = 0; p < set.size(); ++p) {
      Rings rings;
      for (std::uint32_t r = set.first_ring(p); r < set.ends[p]; ++r) rings.add(set.rings[r]);
      TrapezoidList trapezoids;
      triangulation.triangulate(rings, 0, static_cast<std::uint32_t>(rings.size()), kEverything,
                                trapezoids);
      TrapezoidalGraph graph;
      ASSERT_TRUE(GraphBuilder().build(rings, graph).built);
      const double expected = static_cast<double>(graph.doubled_area()) / 2;
      EXPECT_NEAR(area_of(trapezoids), expected, 1e-9 * expected + 1e-6);
    }
  }
}

}  // namespace
}  // namespace trapeze::experiment
