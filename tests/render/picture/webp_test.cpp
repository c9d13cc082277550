#include "render/picture/webp.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#ifdef TRAPEZE_TEST_WEBP
#include <webp/decode.h>
#endif

namespace trapeze {
namespace {

#ifdef TRAPEZE_TEST_WEBP

Picture random_picture(int width, int height, std::size_t colours) {
  std::mt19937 random(5);
  const auto byte = [&random] { return static_cast<std::uint8_t>(random() % 256); };
  std::vector<Rgba> palette;
  for (std::size_t i = 0; i < colours; ++i) palette.push_back({byte(), byte(), byte(), byte()});
  Picture picture{width, height, {}};
  for (int i = 0; i < width * height; ++i) picture.pixels.push_back(palette[random() % colours]);
  return picture;
}

TEST(WebpTest, NoPixelChanges) {
  ASSERT_TRUE(has_webp());
  for (const std::size_t colours : {9u, 2000u}) {
    const Picture picture = random_picture(37, 21, colours);
    const std::string bytes = encode_webp(to_runs(picture));
    int width = 0;
    int height = 0;
    std::uint8_t* pixels = WebPDecodeRGBA(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                          bytes.size(), &width, &height);
    ASSERT_NE(pixels, nullptr);
    EXPECT_EQ(width, 37);
    EXPECT_EQ(height, 21);
    for (int i = 0; i < width * height; ++i) {
      const Rgba decoded{pixels[4 * i], pixels[4 * i + 1], pixels[4 * i + 2], pixels[4 * i + 3]};
      ASSERT_EQ(decoded, picture.at(i % width, i / width)) << i;
    }
    WebPFree(pixels);
  }
}

TEST(WebpTest, NothingCannotBeEncoded) {
  EXPECT_THROW(encode_webp(RunPicture()), std::runtime_error);
}

#else

TEST(WebpTest, WithoutTheLibraryItSaysSo) {
  EXPECT_FALSE(has_webp());
  EXPECT_THROW(encode_webp(RunPicture()), std::runtime_error);
}

#endif

}  // namespace
}  // namespace trapeze
