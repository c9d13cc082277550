#include "render/mask/mask.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

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

}  // namespace
}  // namespace trapeze
