#include "bench/experiment/open_trapezoids.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/core/polygon_families.h"
#include "core/sweep/clean_rings.h"
#include "core/sweep/graph_builder.h"
#include "tests/core/shapes/ring_text.h"
#include "tests/core/shapes/shapes.h"
#include "tests/experiment/sample_map.h"

namespace trapeze::experiment {
namespace {

constexpr unsigned kOpenShapes = 350;
using Boundary = OpenTrapezoids::Boundary;

using Numbers = std::array<std::int32_t, 10>;

std::vector<Numbers> sorted(const std::vector<TrapezoidRecord>& records) {
  std::vector<Numbers> numbers;
  for (const TrapezoidRecord& t : records) {
    numbers.push_back({t.top, t.bottom, t.left_upper.x, t.left_upper.y, t.left_lower.x,
                       t.left_lower.y, t.right_upper.x, t.right_upper.y, t.right_lower.x,
                       t.right_lower.y});
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

/// The trapezoids of the core's plane sweep that have height.
std::vector<Numbers> of_the_core(Rings rings) {
  TrapezoidalGraph graph;
  GraphBuilder builder;
  std::vector<TrapezoidRecord> records;
  if (!builder.build(rings, graph).built) return {};
  for (const NodeId n : graph.inside_nodes()) {
    const Node& node = graph.node(n);
    const auto point = [&](Side side, Direction d) {
      return graph.point(graph.edge(node.edge[side]).end[d]);
    };
    const TrapezoidRecord record{graph.point(node.end[kUp]).y,
                                 graph.point(node.end[kDown]).y,
                                 point(kLeft, kUp),
                                 point(kLeft, kDown),
                                 point(kRight, kUp),
                                 point(kRight, kDown)};
    if (record.top < record.bottom) records.push_back(record);
  }
  return sorted(records);
}

TrapezoidList tessellated(const Rings& rings, Boundary boundary, const Box& view = kEverything) {
  OpenTrapezoids open;
  TrapezoidList trapezoids;
  open.tessellate(rings, 0, static_cast<std::uint32_t>(rings.size()), view, boundary, trapezoids);
  return trapezoids;
}

double area_between(const TrapezoidRecord& t, std::int32_t top, std::int32_t bottom) {
  const std::int32_t from = std::max(t.top, top);
  const std::int32_t to = std::min(t.bottom, bottom);
  if (from >= to) return 0;
  const auto width = [&](std::int32_t y) {
    return x_at(t.right_upper, t.right_lower, y) - x_at(t.left_upper, t.left_lower, y);
  };
  return (width(from) + width(to)) / 2 * (static_cast<double>(to) - from);
}

double area_between(const TrapezoidList& trapezoids, std::int32_t top, std::int32_t bottom) {
  double area = 0;
  for (const TrapezoidRecord& t : trapezoids.records) area += area_between(t, top, bottom);
  return area;
}

TEST(OpenTrapezoids, AreTheTrapezoidsOfTheCore) {
  for (const PolygonSet& set : random_polygon_sets(kOpenShapes)) {
    for (std::size_t p = 0; p < set.size(); ++p) {
      Rings rings;
      for (std::uint32_t r = set.first_ring(p); r < set.ends[p]; ++r) rings.add(set.rings[r]);
      const std::vector<Numbers> expected = of_the_core(rings);
      ASSERT_EQ(sorted(tessellated(rings, Boundary::simple).records), expected);
      ASSERT_EQ(sorted(tessellated(rings, Boundary::uncertain).records), expected);
    }
  }
}

TEST(OpenTrapezoids, AreTheTrapezoidsOfTheCoreForEveryFamily) {
  for (const PolygonFamily& family : kPolygonFamilies) {
    const Rings rings = family.make(500);
    EXPECT_EQ(sorted(tessellated(rings, Boundary::simple).records), of_the_core(rings))
        << family.name;
  }
}

TEST(OpenTrapezoids, NodesWhatCrosses) {
  const Rings bow_tie = rings_from_text("0 0, 100 100, 100 0, 0 100");
  OpenTrapezoids open;
  TrapezoidList trapezoids;
  open.tessellate(bow_tie, 0, 1, kEverything, Boundary::uncertain, trapezoids);
  EXPECT_EQ(open.noded(), 1u);
  EXPECT_EQ(area_between(trapezoids, 0, 100), 5000);
}

// Without previous cleaning, as after a simplification without topology.
TEST(OpenTrapezoids, DrawRingsInAnyStateByEvenOdd) {
  for (unsigned seed = 0; seed < kOpenShapes; ++seed) {
    const Rings rings = random_shape(seed);
    Rings clean = rings;
    clean_rings(clean);
    if (clean.empty()) continue;
    TrapezoidalGraph graph;
    Rings copy = clean;
    const bool is_built = GraphBuilder().build(copy, graph).built;
    const double expected = is_built ? static_cast<double>(graph.doubled_area()) / 2 : 0;
    const double area = area_between(tessellated(clean, Boundary::uncertain), kGridMin, kGridMax);
    EXPECT_NEAR(area, expected, 1e-9 * std::abs(expected) + 1e-6) << "seed " << seed;
  }
}

TEST(OpenTrapezoids, CutToTheViewCoverWhatTheyCoverThere) {
  UnitNumbers random(3);
  for (const PolygonSet& set : random_polygon_sets(kOpenShapes)) {
    for (std::size_t p = 0; p < set.size(); ++p) {
      Rings rings;
      for (std::uint32_t r = set.first_ring(p); r < set.ends[p]; ++r) rings.add(set.rings[r]);
      const TrapezoidList all = tessellated(rings, Boundary::simple);
      const Box& box = set.boxes[p];
      const double height = static_cast<double>(box.max_y) - box.min_y;
      // Includes rows at the y of vertices.
      const auto top = static_cast<std::int32_t>(box.min_y + height * random.next());
      const std::int32_t bottom = rings
                                      .points[static_cast<std::size_t>(
                                          random.next() * static_cast<double>(rings.points.size()))]
                                      .y;
      const Box view{kGridMin, std::min(top, bottom), kGridMax, std::max(top, bottom)};
      for (const Boundary boundary : {Boundary::simple, Boundary::uncertain}) {
        const TrapezoidList cut = tessellated(rings, boundary, view);
        for (const TrapezoidRecord& t : cut.records) {
          ASSERT_GE(t.top, view.min_y);
          ASSERT_LE(t.bottom, view.max_y);
        }
        const double expected = area_between(all, view.min_y, view.max_y);
        ASSERT_NEAR(area_between(cut, view.min_y, view.max_y), expected, 1e-9 * expected + 1e-6);
      }
    }
  }
}

}  // namespace
}  // namespace trapeze::experiment
