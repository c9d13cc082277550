#include "core/grid/box_segment.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

namespace trapeze {
namespace {

bool is_between(Point p, Point a, Point b) {
  Box box;
  box.include(a);
  box.include(b);
  return box.min_x <= p.x && p.x <= box.max_x && box.min_y <= p.y && p.y <= box.max_y;
}

int sign(std::int64_t number) {
  return (number > 0 ? 1 : 0) - (number < 0 ? 1 : 0);
}

bool cross(Point a, Point b, Point c, Point d) {
  const int c_side = sign(orientation(a, b, c));
  const int d_side = sign(orientation(a, b, d));
  const int a_side = sign(orientation(c, d, a));
  const int b_side = sign(orientation(c, d, b));
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  return (c_side == 0 && is_between(c, a, b)) || (d_side == 0 && is_between(d, a, b)) ||
         (a_side == 0 && is_between(a, c, d)) || (b_side == 0 && is_between(b, c, d));
}

/// One of the points is in the box, or the line meets one of its sides.
bool meet_as_defined(Point from, Point to, const Box& box) {
  const std::array<Point, 4> corners = {Point{box.min_x, box.min_y}, Point{box.max_x, box.min_y},
                                        Point{box.max_x, box.max_y}, Point{box.min_x, box.max_y}};
  if (is_between(from, corners[0], corners[2]) || is_between(to, corners[0], corners[2])) {
    return true;
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (cross(from, to, corners[i], corners[(i + 1) % corners.size()])) return true;
  }
  return false;
}

TEST(BoxSegment, MeetsABoxWhereItHasAPointInIt) {
  constexpr std::array<Box, 4> kBoxes = {Box{-1, -1, 1, 1}, Box{-2, 0, 1, 1}, Box{0, -1, 0, 2},
                                         Box{1, 1, 1, 1}};
  std::vector<Point> points;
  for (std::int32_t y = -4; y <= 4; ++y) {
    for (std::int32_t x = -4; x <= 4; ++x) points.push_back({x, y});
  }
  int met = 0;
  int near_only = 0;  // boxes around lines that pass by
  for (const Box& box : kBoxes) {
    for (const Point from : points) {
      for (const Point to : points) {
        const bool is_met = meet_as_defined(from, to, box);
        ASSERT_EQ(meets(from, to, box), is_met)
            << from.x << ' ' << from.y << ", " << to.x << ' ' << to.y << ", box " << box.min_x
            << ' ' << box.min_y;
        Box around;
        around.include(from);
        around.include(to);
        met += is_met;
        near_only += !is_met && around.intersects(box);
      }
    }
  }
  EXPECT_GT(met, 1000);
  EXPECT_GT(near_only, 1000);
}

TEST(BoxSegment, IsExactOverTheWholeGrid) {
  const Box corner{kGridMax - 1, kGridMin, kGridMax, kGridMin + 1};
  EXPECT_TRUE(meets({kGridMin, kGridMin}, {kGridMax, kGridMin + 1}, corner));
  EXPECT_FALSE(meets({kGridMin, kGridMin}, {kGridMax, kGridMax}, corner));
  // Passes through the corner of a box, and half a cell beside it.
  EXPECT_TRUE(meets({kGridMin, kGridMin}, {kGridMax, kGridMax}, {10, 0, 20, 10}));
  EXPECT_FALSE(meets({kGridMin, kGridMin + 1}, {kGridMax, kGridMax}, {10, 0, 20, 10}));
}

}  // namespace
}  // namespace trapeze
