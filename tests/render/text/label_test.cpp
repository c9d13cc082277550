#include "render/text/label.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "render/text/usual_fonts.h"

namespace trapeze {
namespace {

constexpr Rgba kPlate{255, 255, 255, 255};
constexpr Rgba kBlack{0, 0, 0, 255};
constexpr TextStyle kStyle{12, kBlack};

Picture black_picture(int width, int height) {
  Picture picture;
  picture.width = width;
  picture.height = height;
  picture.pixels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kBlack);
  return picture;
}

class LabelTest : public ::testing::Test {
 protected:
  LabelTest() { fonts_.add(usual_fonts().at(0)); }

  Fonts fonts_;
};

TEST_F(LabelTest, BlackTextIsReadableOnBlackGround) {
  Picture picture = black_picture(64, 32);
  draw_label("17", 3, 3, kStyle, fonts_, picture);
  EXPECT_EQ(picture.at(3, 3), kPlate) << "the plate";
  EXPECT_EQ(picture.at(2, 3), kBlack) << "beside it";
  const int right = 3 + fonts_.width_of("17", kStyle.size) + 4;
  EXPECT_EQ(picture.at(right - 1, 3), kPlate);
  EXPECT_EQ(picture.at(right, 3), kBlack);
  int dark_pixels = 0;
  for (int y = 3; y < 18; ++y) {
    for (int x = 3; x < right; ++x) dark_pixels += picture.at(x, y).r < 100 ? 1 : 0;
  }
  EXPECT_GT(dark_pixels, 10) << "the text";
}

TEST_F(LabelTest, ALabelLongerThanThePictureIsCutOff) {
  for (const int size : {1, 2, 7, 30}) {
    Picture picture = black_picture(size, size);
    draw_label("22/4194303/4194303 4x", 0, 0, kStyle, fonts_, picture);
    EXPECT_EQ(picture.at(0, 0), kPlate);
  }
}

TEST_F(LabelTest, WithoutTextThereIsNoPlate) {
  Picture picture = black_picture(30, 30);
  draw_label("", 3, 3, kStyle, fonts_, picture);
  draw_label("17", 3, 3, kStyle, Fonts(), picture);
  EXPECT_TRUE(std::ranges::all_of(picture.pixels, [](Rgba pixel) { return pixel == kBlack; }));
}

}  // namespace
}  // namespace trapeze
