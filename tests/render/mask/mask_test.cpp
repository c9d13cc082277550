#include "render/mask/mask.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/render/masks.h"

namespace trapeze {
namespace {

TEST(ViewTest, OfATileHasItsCornerAndItsSide) {
  const View view = View::of_tile({3, 5, 2}, 2);
  EXPECT_EQ(view.origin_x, kGridMin + 5 * (kGridSize >> 3));
  EXPECT_EQ(view.origin_y, kGridMin + 2 * (kGridSize >> 3));
  EXPECT_EQ(view.width, 512);
  EXPECT_EQ(view.height, 512);
  EXPECT_EQ(view.cells_per_pixel * 512, static_cast<double>(kGridSize >> 3));
}

TEST(ViewTest, OfTheDeepestTileIsFinerThanTheGrid) {
  const View view = View::of_tile({kMaxZoom, 0, 0}, 2);
  EXPECT_EQ(view.cells_per_pixel, 0.25);
}

TEST(ViewTest, BoxOfTheWorldIsTheGrid) {
  EXPECT_EQ(View::of_tile({0, 0, 0}).box(), (Box{kGridMin, kGridMin, kGridMax, kGridMax}));
}

TEST(ViewTest, BoxIsCutToTheGridAndEmptyOffTheWorld) {
  const View across{kGridMin - std::int64_t{100}, 0, 1, 256, 10};
  EXPECT_EQ(across.box(), (Box{kGridMin, 0, kGridMin + 156, 10}));
  const View off{kGridMax + std::int64_t{100}, 0, 1, 256, 10};
  EXPECT_TRUE(off.box().is_empty());
}

TEST(ViewTest, BoxOfABandIsThatOfItsRows) {
  View view{100, 200, 1.5, 10, 20};
  view.stretch = 2;
  EXPECT_EQ(view.box(), (Box{100, 200, 115, 260}));
  EXPECT_EQ(view.band(5, 3).box(), (Box{100, 215, 115, 224}));
  EXPECT_EQ(view.band(5, 10).band(1, 1).box(), (Box{100, 218, 115, 221}));
}

TEST(ViewTest, IsOnTheWorldOnlyAsAWhole) {
  EXPECT_TRUE(View::of_tile({0, 0, 0}).is_on_world());
  EXPECT_TRUE(View::of_tile({kMaxZoom, 0, 0}, 4).is_on_world());
  for (const View& off : {View{kGridMin - std::int64_t{1}, 0, 1, 10, 10},
                          View{kGridMax - std::int64_t{9}, 0, 1, 10, 10},
                          View{0, kGridMin - std::int64_t{1}, 1, 10, 10},
                          View{0, kGridMax - std::int64_t{9}, 1, 10, 10}}) {
    EXPECT_FALSE(off.is_on_world());
  }
}

TEST(MaskTest, IsJoinedWithAnotherByTheSumOrTheGreaterValue) {
  Mask a(4, 2, 200);
  Mask b;
  b.begin(4, 2);
  b.append(1, 0);
  b.append(4, 100);
  b.end_row();
  b.append(4, 10);
  b.end_row();
  const auto row_of = [](const Mask& mask, int row) {
    std::vector<int> values;
    for (int column = 0; column < mask.width(); ++column) values.push_back(mask.at(column, row));
    return values;
  };
  EXPECT_EQ(row_of(sum_of(a, b), 0), (std::vector{200, 255, 255, 255}));
  EXPECT_EQ(row_of(sum_of(a, b), 1), (std::vector{210, 210, 210, 210}));
  EXPECT_EQ(sum_of(b, a), sum_of(a, b));
  EXPECT_TRUE(greater_of(a, b).is_all(200));
  EXPECT_EQ(greater_of(b, Mask(4, 2, 0)), b);
}

TEST(ViewTest, RefusesWhatCannotBeDrawn) {
  const View fine{0, 0, 1, 10, 10};
  EXPECT_NO_THROW(fine.check());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const View& bad :
       {View{0, 0, 1, 0, 10}, View{0, 0, 1, 10, -1}, View{0, 0, 1, kMaxPicturePixels + 1, 10},
        View{0, 0, 0, 10, 10}, View{0, 0, -1, 10, 10}, View{0, 0, nan, 10, 10},
        View{std::int64_t{1} << 60, 0, 1, 10, 10}}) {
    EXPECT_THROW(bad.check(), std::invalid_argument);
  }
}

TEST(MaskTest, RunsAreThoseOfItsPixels) {
  std::mt19937 random(3);
  Mask mask;
  for (const int width : {1, 2, 17, 400}) {
    std::vector<std::uint8_t> values(static_cast<std::size_t>(5 * width));
    std::ranges::generate(values, [&] { return static_cast<std::uint8_t>(random() % 2); });
    mask.begin(width, 5);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t end = i % static_cast<std::size_t>(width) + 1;
      mask.append(end, values[i]);
      if (end == static_cast<std::size_t>(width)) mask.end_row();
    }
    ASSERT_EQ(testing::values_of(mask), values);
    std::vector<std::uint8_t> copied(static_cast<std::size_t>(width) + Mask::kCopyRoom);
    for (int row = 0; row < 5; ++row) {
      mask.copy_row(row, copied.data());
      for (int column = 0; column < width; ++column) {
        const std::uint8_t value = values[static_cast<std::size_t>(row * width + column)];
        ASSERT_EQ(mask.at(column, row), value);
        ASSERT_EQ(copied[static_cast<std::size_t>(column)], value);
      }
    }
    EXPECT_EQ(mask, testing::mask_by(width, 5, [&](int column, int row) {
                return values[static_cast<std::size_t>(row * width + column)];
              }));
  }
  EXPECT_TRUE(Mask(300, 4, 7).is_all(7));
  EXPECT_FALSE(Mask(300, 4, 7).is_all(0));
  EXPECT_FALSE(mask.is_all(0));
  EXPECT_NE(Mask(4, 3, 1), Mask(3, 4, 1));
}

}  // namespace
}  // namespace trapeze
