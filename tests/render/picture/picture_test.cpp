#include "render/picture/picture.h"

#include <gtest/gtest.h>

#include <random>

namespace trapeze {
namespace {

Picture random_picture(int width, int height, std::mt19937& random) {
  Picture picture{width, height, {}};
  while (picture.pixels.size() < static_cast<std::size_t>(width * height)) {
    const Rgba colour{static_cast<std::uint8_t>(random() % 5), 2, 3, 255};
    picture.pixels.resize(picture.pixels.size() + 1 + random() % 9, colour);
  }
  picture.pixels.resize(static_cast<std::size_t>(width * height));
  return picture;
}

TEST(PictureTest, RunsAreTheSamePicture) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (const int width : {1, 13, 64}) {
    const Picture picture = random_picture(width, 11, random);
    const RunPicture runs = to_runs(picture);
    EXPECT_EQ(to_pixels(runs).pixels, picture.pixels);
    for (int row = 0; row < 11; ++row) {
      EXPECT_EQ(runs.row(row).back().end, static_cast<std::uint32_t>(width));
      for (std::size_t i = 1; i < runs.row(row).size(); ++i) {
        EXPECT_NE(runs.row(row)[i].colour, runs.row(row)[i - 1].colour);
      }
      for (int column = 0; column < width; ++column) {
        EXPECT_EQ(runs.at(column, row), picture.at(column, row));
      }
    }
  }
}

TEST(PictureTest, APictureOfOneColourIsConstant) {
  Picture picture{9, 4, std::vector<Rgba>(36, Rgba{1, 2, 3, 4})};
  EXPECT_TRUE(to_runs(picture).is_constant());
  picture.pixels[30] = kTransparent;
  EXPECT_FALSE(to_runs(picture).is_constant());
}

TEST(PictureTest, PicturesAreJoinedOneBelowTheOther) {
  std::mt19937 random(1);
  const std::vector<Picture> parts{random_picture(13, 4, random), random_picture(13, 1, random),
                                   random_picture(13, 6, random)};
  std::vector<RunPicture> runs;
  std::vector<Rgba> pixels;
  for (const Picture& part : parts) {
    runs.push_back(to_runs(part));
    pixels.insert(pixels.end(), part.pixels.begin(), part.pixels.end());
  }
  const RunPicture all = joined(std::vector<const RunPicture*>{&runs[0], &runs[1], &runs[2]});
  EXPECT_EQ(all.width, 13);
  EXPECT_EQ(all.height, 11);
  EXPECT_EQ(to_pixels(all).pixels, pixels);
  EXPECT_LE(all.colours.size(), 5u) << "each colour is there once";
}

}  // namespace
}  // namespace trapeze
