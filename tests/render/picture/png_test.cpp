#include "render/picture/png.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace trapeze {
namespace {

// Read from the header: bits a sample, and the colour type: 3 palette, 2 RGB, 6 RGBA.
int bits_of(const std::string& png) {
  return png.at(24);
}
int colour_type_of(const std::string& png) {
  return png.at(25);
}

void expect_equal(const Picture& expected, const Picture& actual) {
  ASSERT_EQ(actual.width, expected.width);
  ASSERT_EQ(actual.height, expected.height);
  for (int row = 0; row < expected.height; ++row) {
    for (int column = 0; column < expected.width; ++column) {
      ASSERT_EQ(actual.at(column, row), expected.at(column, row)) << column << ", " << row;
    }
  }
}

Picture constant(int side, Rgba colour) {
  return {side, side, std::vector<Rgba>(static_cast<std::size_t>(side * side), colour)};
}

std::string encode(const Picture& picture) {
  return PngEncoder().encode(to_runs(picture));
}

Picture indexed(int width, int height, std::size_t colours, std::mt19937& random) {
  std::vector<Rgba> palette;
  for (std::size_t i = 0; i < colours; ++i) {
    palette.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(random()), 7,
                       static_cast<std::uint8_t>(random() % 2 == 0 ? 255 : 1 + i % 254)});
  }
  Picture picture{width, height, {}};
  for (std::size_t i = 0; i < static_cast<std::size_t>(width * height); ++i) {
    picture.pixels.push_back(palette[i < colours ? i : random() % colours]);
  }
  return picture;
}

TEST(PngTest, IndexedPicturesComeBackWithTheFewestBits) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const struct {
    std::size_t colours;
    int bits;
  } cases[] = {{1, 1}, {2, 1}, {3, 2}, {4, 2}, {5, 4}, {16, 4}, {17, 8}, {256, 8}};
  for (const auto& [colours, bits] : cases) {
    for (const int width : {256, 255, 37}) {
      const Picture picture = indexed(width, 19, colours, random);
      const auto png = encode(picture);
      EXPECT_EQ(colour_type_of(png), 3);
      EXPECT_EQ(bits_of(png), bits) << colours;
      expect_equal(picture, decode_png(png));
    }
  }
}

TEST(PngTest, ColourPicturesComeBackWithAndWithoutOpacity) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (const bool is_opaque : {false, true}) {
    Picture picture{61, 33, {}};
    for (int i = 0; i < 61 * 33; ++i) {
      const auto byte = [&] { return static_cast<std::uint8_t>(random()); };
      picture.pixels.push_back({byte(), byte(), byte(), is_opaque ? std::uint8_t{255} : byte()});
    }
    const auto png = encode(picture);
    EXPECT_EQ(colour_type_of(png), is_opaque ? 2 : 6);
    expect_equal(picture, decode_png(png));
  }
}

TEST(PngTest, AConstantTileIsTiny) {
  for (const Rgba colour : {kTransparent, Rgba{10, 20, 30, 255}}) {
    EXPECT_LT(encode(constant(256, colour)).size(), 200u);
  }
}

TEST(PngTest, OneEncoderKeepsPicturesApart) {
  std::mt19937 random(5);
  PngEncoder encoder;
  for (const int width : {300, 20, 256}) {
    const Picture indexed_picture = indexed(width, 40, 200, random);
    expect_equal(indexed_picture, decode_png(encoder.encode(to_runs(indexed_picture))));
    Picture coloured{width, 3, {}};
    coloured.pixels.assign(static_cast<std::size_t>(width) * 3, Rgba{1, 2, 3, 4});
    expect_equal(coloured, decode_png(encoder.encode(to_runs(coloured))));
    EXPECT_EQ(encoder.encode(to_runs(coloured)), encode(coloured));
  }
}

TEST(PngTest, RefusesWhatCannotBeEncoded) {
  EXPECT_THROW(PngEncoder().encode(RunPicture{}), std::runtime_error);
}

TEST(PngTest, RefusesWhatIsNoPng) {
  EXPECT_THROW(decode_png({}), std::runtime_error);
  EXPECT_THROW(decode_png("hello world"), std::runtime_error);
  std::string cut = encode(constant(64, {1, 2, 3, 255}));
  cut.resize(cut.size() / 2);
  EXPECT_THROW(decode_png(cut), std::runtime_error);
}

}  // namespace
}  // namespace trapeze
