#include "core/grid/area_moments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace trapeze {
namespace {

AreaMoments moments_of(const std::vector<Point>& ring) {
  BoundaryMoments moments(ring.front());
  for (std::size_t i = 0; i < ring.size(); ++i) moments.add(ring[i], ring[(i + 1) % ring.size()]);
  return moments.sum();
}

double length_of(Axis axis) {
  return std::hypot(static_cast<double>(axis.to.x) - axis.from.x,
                    static_cast<double>(axis.to.y) - axis.from.y);
}

constexpr std::int32_t kFar = kGridMax - 10'000;

TEST(AreaMomentsTest, OfARectangleAreItsOwnWhereverItLies) {
  for (const std::int32_t x : {0, kFar, -kFar}) {
    const AreaMoments m = moments_of({{x, 100}, {x + 600, 100}, {x + 600, 300}, {x, 300}});
    EXPECT_EQ(m.area, 120'000);
    EXPECT_EQ(m.x, x + 300.0);
    EXPECT_EQ(m.y, 200);
    EXPECT_NEAR(m.xx, 120'000 * 600.0 * 600 / 12, 1);
    EXPECT_NEAR(m.yy, 120'000 * 200.0 * 200 / 12, 1);
    EXPECT_NEAR(m.xy, 0, 1);
    const Axis axis = m.axis();
    EXPECT_EQ(axis.from.y, 200);
    EXPECT_EQ(axis.to.y, 200);
    EXPECT_NEAR(length_of(axis), 600, 1);
    EXPECT_TRUE(m.is_compact());
  }
}

TEST(AreaMomentsTest, DoNotDependOnTheDirectionOfTheBoundary) {
  const AreaMoments a = moments_of({{0, 0}, {900, 100}, {300, 500}});
  const AreaMoments b = moments_of({{300, 500}, {900, 100}, {0, 0}});
  EXPECT_NEAR(a.area, b.area, 1e-6);
  EXPECT_NEAR(a.x, 400, 1e-9);
  EXPECT_NEAR(b.x, 400, 1e-9);
  EXPECT_NEAR(a.xy, b.xy, 1e-3);
}

TEST(AreaMomentsTest, TheAxisOfASlantedStripRunsAlongIt) {
  // 1000 long in the direction (3, 4), 100 wide.
  const AreaMoments m = moments_of({{0, 0}, {600, 800}, {520, 860}, {-80, 60}});
  const Axis axis = m.axis();
  EXPECT_NEAR(length_of(axis), 1000, 2);
  EXPECT_NEAR((axis.to.y - axis.from.y) * 1.0 / (axis.to.x - axis.from.x), 4.0 / 3, 0.01);
  EXPECT_TRUE(m.is_compact());
}

TEST(AreaMomentsTest, TheAxisOfANeedleDoesNotStickOut) {
  const Axis axis = moments_of({{0, 0}, {40'000, 30'000}, {-3, 4}}).axis();
  for (const Point end : {axis.from, axis.to}) {
    EXPECT_GE(end.x, -4);
    EXPECT_GE(end.y, -1);
  }
  EXPECT_NEAR(std::max(axis.from.x, axis.to.x), 0.742 * 40'000, 40);
}

TEST(AreaMomentsTest, OfTwoPiecesAreThoseOfTheWhole) {
  AreaMoments west = moments_of({{0, 0}, {200, 0}, {200, 300}, {0, 300}});
  const AreaMoments east = moments_of({{200, 0}, {700, 0}, {700, 300}, {200, 300}});
  const AreaMoments whole = moments_of({{0, 0}, {700, 0}, {700, 300}, {0, 300}});
  west.unite(east);
  EXPECT_NEAR(west.area, whole.area, 1e-6);
  EXPECT_NEAR(west.x, whole.x, 1e-9);
  EXPECT_NEAR(west.xx, whole.xx, 1e-3);
  EXPECT_NEAR(west.yy, whole.yy, 1e-3);
}

TEST(AreaMomentsTest, HooksAndRingsAreNotCompact) {
  EXPECT_FALSE(moments_of({{0, 0}, {1000, 0}, {1000, 100}, {100, 100}, {100, 1000}, {0, 1000}})
                   .is_compact());
  EXPECT_TRUE(moments_of({{0, 0}, {1000, 0}, {0, 1000}}).is_compact());
  BoundaryMoments ring(Point{0, 0});
  const std::vector<Point> outer = {{0, 0}, {1000, 0}, {1000, 1000}, {0, 1000}};
  const std::vector<Point> inner = {{100, 100}, {100, 900}, {900, 900}, {900, 100}};
  for (std::size_t i = 0; i < 4; ++i) {
    ring.add(outer[i], outer[(i + 1) % 4]);
    ring.add(inner[i], inner[(i + 1) % 4]);
  }
  EXPECT_EQ(ring.sum().area, 1'000'000 - 640'000);
  EXPECT_FALSE(ring.sum().is_compact());
}

TEST(AreaMomentsTest, OfNothingLieWhereItBegan) {
  const AreaMoments m = moments_of({{5, 7}, {9, 7}, {5, 7}});
  EXPECT_EQ(m.area, 0);
  EXPECT_EQ(m.axis().from, (Point{5, 7}));
  EXPECT_EQ(m.axis().to, (Point{5, 7}));
}

}  // namespace
}  // namespace trapeze
