#include "bench/experiment/beyond_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/core/polygon_families.h"
#include "tests/core/shapes/ring_text.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze::experiment {
namespace {

Rings with_short_cuts(const Rings& rings, const Box& view) {
  Rings shortened;
  append_with_short_cuts(rings, 0, static_cast<std::uint32_t>(rings.size()), view, shortened);
  return shortened;
}

TEST(BeyondView, VerticesInARowOnOneSideGo) {
  const Rings rings = rings_from_text("0 0, 20 1, 30 8, 40 2, 50 9, 20 11, 0 10");
  const Rings shortened = with_short_cuts(rings, {-5, -5, 15, 15});
  EXPECT_EQ(shortened.points, rings_from_text("0 0, 20 1, 20 11, 0 10").points);
  EXPECT_EQ(shortened.ends, (std::vector<std::uint32_t>{4}));
}

TEST(BeyondView, ACornerOfTheViewIsNotCutOff) {
  const Rings rings = rings_from_text("0 20, 20 20, 20 0, 0 0");
  EXPECT_EQ(with_short_cuts(rings, {-5, -5, 10, 10}).points, rings.points);
}

TEST(BeyondView, RingsOnOneSideGoAndOthersStay) {
  const Rings rings = rings_from_text("0 0, 9 0, 9 9; 20 0, 29 0, 29 9, 20 9");
  EXPECT_EQ(with_short_cuts(rings, {0, 0, 10, 10}).points, rings_from_text("0 0, 9 0, 9 9").points);
  EXPECT_TRUE(with_short_cuts(rings, {100, 100, 110, 110}).empty());
}

TEST(BeyondView, InTheViewTheSameIsInside) {
  UnitNumbers random(11);
  std::size_t shortened_vertices = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const Rings rings = random_shape(seed);
    Box bounds;
    for (const Point p : rings.points) bounds.include(p);
    const auto some_x = [&] {
      return bounds.min_x + random.next() * (double{1} * bounds.max_x - bounds.min_x);
    };
    const auto some_y = [&] {
      return bounds.min_y + random.next() * (double{1} * bounds.max_y - bounds.min_y);
    };
    Box view;
    view.include(cell_at(some_x(), some_y()));
    view.include(cell_at(some_x(), some_y()));
    const Rings shortened = with_short_cuts(rings, view);
    ASSERT_LE(shortened.points.size(), rings.points.size());
    shortened_vertices += rings.points.size() - shortened.points.size();
    for (int i = 0; i < 50; ++i) {
      const double x = view.min_x + random.next() * (double{1} * view.max_x - view.min_x);
      const double y =
          std::floor(view.min_y + random.next() * (double{1} * view.max_y - view.min_y)) + 0.37;
      if (y > view.max_y) continue;
      ASSERT_EQ(is_inside(shortened, x, y), is_inside(rings, x, y))
          << "seed " << seed << " at " << x << ' ' << y;
    }
  }
  EXPECT_GT(shortened_vertices, 300u) << "the views are too large to test anything";
}

}  // namespace
}  // namespace trapeze::experiment
