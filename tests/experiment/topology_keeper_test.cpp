#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/core/polygon_families.h"
#include "bench/experiment/quality.h"
#include "bench/experiment/resimplifying.h"
#include "tests/core/shapes/ring_text.h"
#include "tests/experiment/sample_map.h"

namespace trapeze::experiment {
namespace {

using ::testing::Gt;

constexpr unsigned kKeptShapes = 420;

SimplifiedPolygons simplified(const PolygonSet& set, Topology topology, double epsilon,
                              Method method = Method::blg_tree) {
  LayerSimplifier simplifier(set, make_ring_simplifier(method, set), topology);
  SimplifiedPolygons polygons;
  simplifier.simplify(kEverything, epsilon, polygons);
  return polygons;
}

std::size_t count_invalid(const SimplifiedPolygons& polygons) {
  std::size_t invalid = 0;
  for (std::size_t p = 0; p < polygons.size(); ++p) {
    invalid += is_valid_polygon(polygons.rings, polygons.first_ring(p), polygons.ends[p]) ? 0 : 1;
  }
  return invalid;
}

PolygonSet set_of(const Rings& rings) {
  PolygonSet set;
  set.add_feature(rings);
  return set;
}

TEST(PointGrid, FindsWhatLookingAtAllFinds) {
  UnitNumbers random(7);
  const auto number = [&random](double from, double to) {
    return static_cast<std::int32_t>(from + (to - from) * random.next());
  };
  PointGrid grid;
  for (const std::int32_t height : {1, 50, 1000000}) {
    std::vector<Point> points;
    for (int i = 0; i < 300; ++i) points.push_back({number(-5000, 5000), number(0, height)});
    grid.assign(points);
    for (int i = 0; i < 300; ++i) {
      const std::int32_t x = number(-6000, 6000);
      const std::int32_t y = number(-10, height + 10.0);
      const Box box{x, y, x + number(0, 800), y + number(0, height / 5.0)};
      const auto is_in_box = [&box](Point p) { return box.intersects({p.x, p.y, p.x, p.y}); };
      EXPECT_EQ(grid.any_in(box, is_in_box), std::ranges::any_of(points, is_in_box));
    }
  }
}

TEST(TopologyKeeper, KeepsAVertexWhoseLossWouldPutAHoleOutside) {
  // The shell bulges to the right around a hole by less than the tolerance.
  const PolygonSet set =
      set_of(rings_from_text("0 0, 100 0, 108 50, 100 100, 0 100; 101 45, 105 50, 101 55"));
  ASSERT_EQ(set.rings.size(), 2u);
  const SimplifiedPolygons fast = simplified(set, Topology::fast, 12);
  EXPECT_EQ(fast.rings[0].size(), 4u);
  // The hole is smaller than the tolerance, so that it is removed, and the shell's vertex may be
  // removed too.
  EXPECT_EQ(simplified(set, Topology::strict, 12).rings[0].size(), 4u);
  const PolygonSet long_hole =
      set_of(rings_from_text("0 0, 100 0, 108 50, 100 100, 0 100; 60 45, 105 50, 60 80"));
  EXPECT_EQ(simplified(long_hole, Topology::fast, 12).rings[0].size(), 4u);
  const SimplifiedPolygons strict = simplified(long_hole, Topology::strict, 12);
  EXPECT_EQ(strict.rings[0].size(), 5u);
  EXPECT_EQ(count_invalid(strict), 0u);
  EXPECT_EQ(count_invalid(simplified(long_hole, Topology::fast, 12)), 1u);
}

// The first ring is a U whose bottom bulges up at (50, 40), with a bay beside the bulge. The tip of
// the second ring is in the bay: the whole bulge does not enclose it, but a part of it does. The
// third ring has to keep its tip because of the U, and the bulge then has to stay because of that
// tip. Only the positions of vertices matter, so the rings may cross.
TEST(TopologyKeeper, TestsPartsAgainstAllThatIsKept) {
  PolygonSet set;
  set.rings = rings_from_text(
      "-100 -300, 200 -300, 200 500, 100 500, 100 0, 50 40, 30 5, 0 0, 0 500, -100 500;"
      "25 10, -400 900, 450 900;"
      "50 -900, 300 -20, 50 10, -200 -20");
  set.ends = {3};
  set.boxes = {kEverything};
  for (std::size_t r = 0; r < 3; ++r) set.second_anchors.push_back(second_anchor_of(set.rings[r]));
  const SimplifiedPolygons fast = simplified(set, Topology::fast, 45);
  EXPECT_EQ(fast.rings[0].size(), 8u);
  EXPECT_EQ(fast.rings[2].size(), 3u);
  const SimplifiedPolygons strict = simplified(set, Topology::strict, 45);
  EXPECT_EQ(strict.rings[0].size(), 10u);
  EXPECT_EQ(strict.rings[2].size(), 4u);
}

TEST(TopologyKeeper, LeavesValidPolygonsOfAnyShape) {
  std::size_t invalid_without = 0;
  const auto sets = random_polygon_sets(kKeptShapes);
  for (unsigned seed = 0; seed < kKeptShapes; ++seed) {
    for (const double epsilon : {0.5, 2.0, 5.0, 10.0, 30.0, 80.0, 300.0, 3000.0, 20000.0}) {
      ASSERT_EQ(count_invalid(simplified(sets[seed], Topology::strict, epsilon)), 0u)
          << "seed " << seed << " tolerance " << epsilon;
      invalid_without += count_invalid(simplified(sets[seed], Topology::fast, epsilon));
    }
  }
  EXPECT_THAT(invalid_without, Gt(30u)) << "the shapes are too easy to test anything";
}

TEST(TopologyKeeper, LeavesValidPolygonsOfEveryFamily) {
  for (const PolygonFamily& family : kPolygonFamilies) {
    const PolygonSet set = set_of(family.make(2000));
    for (double epsilon = 1 << 10; epsilon < 1 << 30; epsilon *= 4) {
      ASSERT_EQ(count_invalid(simplified(set, Topology::strict, epsilon)), 0u)
          << family.name << " tolerance " << epsilon;
    }
  }
}

TEST(TopologyKeeper, GivesTheSameForBothWaysOfSplitting) {
  for (const PolygonSet& set : random_polygon_sets(kKeptShapes)) {
    for (const double epsilon : {5.0, 80.0, 3000.0}) {
      const auto a = simplified(set, Topology::strict, epsilon, Method::blg_tree);
      const auto b = simplified(set, Topology::strict, epsilon, Method::douglas_peucker);
      ASSERT_EQ(a.rings.points, b.rings.points);
      ASSERT_EQ(a.rings.ends, b.rings.ends);
    }
  }
}

TEST(TopologyKeeper, KeepsHardlyMoreThanItHasTo) {
  const PolygonSet coast = set_of(wiggly_star(20000));
  const std::size_t without = simplified(coast, Topology::fast, 1e5).rings.points.size();
  const std::size_t with = simplified(coast, Topology::strict, 1e5).rings.points.size();
  EXPECT_GE(with, without);
  EXPECT_LE(static_cast<double>(with), 1.05 * static_cast<double>(without));
}

}  // namespace
}  // namespace trapeze::experiment
