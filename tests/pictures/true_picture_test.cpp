#include "tests/pictures/true_picture.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace trapeze::testing {
namespace {

/// 4 x 3 pixels of 80 cells.
View small_view() {
  View view;
  view.origin_x = 1000;
  view.origin_y = -500;
  view.cells_per_pixel = 80;
  view.width = 4;
  view.height = 3;
  return view;
}

/// Rings of points in cells from the corner of the small view.
TrueOutlines outlines_of(std::initializer_list<std::vector<Point>> rings) {
  Rings moved;
  for (const std::vector<Point>& ring : rings) {
    for (const Point p : ring) moved.points.push_back({p.x + 1000, p.y - 500});
    moved.close_ring();
  }
  TrueOutlines outlines;
  outlines.add(moved);
  return outlines;
}

std::vector<int> row_of(const Mask& mask, int row) {
  std::vector<int> levels;
  for (int column = 0; column < mask.width(); ++column) levels.push_back(mask.at(column, row));
  return levels;
}

TEST(TruePictureTest, ABoxCoversTheSharesOfItsPixels) {
  // From pixel 0.5 to 2.25 across and 1 to 1.5 down.
  const auto outlines = outlines_of({{{40, 80}, {180, 80}, {180, 120}, {40, 120}}});
  const Mask picture = outlines.draw(small_view());
  EXPECT_EQ(row_of(picture, 0), std::vector<int>({0, 0, 0, 0}));
  EXPECT_EQ(row_of(picture, 1), std::vector<int>({64, 128, 32, 0}));
  EXPECT_EQ(row_of(picture, 2), std::vector<int>({0, 0, 0, 0}));
}

TEST(TruePictureTest, InsideIsEvenOddOverTheRingsOfAFeature) {
  const std::vector<Point> all = {{-500, -500}, {900, -500}, {900, 900}, {-500, 900}};
  const std::vector<Point> hole = {{80, 80}, {160, 80}, {160, 160}, {80, 160}};
  const Mask picture = outlines_of({all, hole}).draw(small_view());
  EXPECT_EQ(row_of(picture, 0), std::vector<int>({255, 255, 255, 255}));
  EXPECT_EQ(row_of(picture, 1), std::vector<int>({255, 0, 255, 255}));
}

TEST(TruePictureTest, FeaturesAddUpToAWholePixelAtMost) {
  auto outlines = outlines_of({{{0, 0}, {80, 0}, {80, 60}, {0, 60}}});
  Rings half;
  half.add(std::vector<Point>{{1000, -500}, {1160, -500}, {1160, -460}, {1000, -460}});
  outlines.add(half);
  EXPECT_EQ(row_of(outlines.draw(small_view()), 0), std::vector<int>({255, 128, 0, 0}));
}

TEST(TruePictureTest, ASlantedEdgeIsSampledWithinASamplesWidth) {
  // Half of the pixel; the points on the diagonal are all inside or all outside.
  const Mask picture = outlines_of({{{80, 0}, {160, 80}, {80, 80}}}).draw(small_view());
  EXPECT_NEAR(picture.at(1, 0), 128, 16);
  EXPECT_EQ(picture.at(0, 0), 0);
  EXPECT_EQ(picture.at(2, 0), 0);
}

}  // namespace
}  // namespace trapeze::testing
