#include "render/text/bitmap_text.h"

#include <gtest/gtest.h>

#include <string>

namespace trapeze {
namespace {

constexpr Rgba kInk{0, 0, 0, 255};

Picture blank(int width, int height) {
  Picture picture;
  picture.width = width;
  picture.height = height;
  picture.pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return picture;
}

/// The text in rows of '#' and '.', zoom 1.
std::string drawn(std::string_view text) {
  Picture picture = blank(text_width(text), kTextAscent + kTextDescent);
  draw_text(text, 0, 0, 1, kInk, picture);
  std::string rows;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) rows += picture.at(x, y) == kInk ? '#' : '.';
    rows += '\n';
  }
  return rows;
}

TEST(BitmapTextTest, LettersLookLikeLetters) {
  EXPECT_EQ(drawn("Tag"),
            "#####............\n"
            "..#..............\n"
            "..#....###...####\n"
            "..#.......#.#...#\n"
            "..#....####.#...#\n"
            "..#...#...#.#...#\n"
            "..#....####..####\n"
            "................#\n"
            ".............###.\n");
}

TEST(BitmapTextTest, EveryLetterDiffersFromEveryOther) {
  for (char a = ' '; a < 127; ++a) {
    for (char b = ' '; b < a; ++b) EXPECT_NE(drawn({&a, 1}), drawn({&b, 1})) << a << b;
  }
}

TEST(BitmapTextTest, AccentsAreLeftOffAndOtherScriptsAreBoxes) {
  EXPECT_EQ(drawn("\u00c5\u00e9\u0159\u017a"), drawn("Aerz"));
  EXPECT_EQ(drawn("\u4e2d"), drawn("\u05d0"));
  EXPECT_EQ(text_width("\u4e2d\u6587"), 11);
}

TEST(BitmapTextTest, BytesThatAreNoTextAreBoxesToo) {
  for (const std::string text : {"\xff", "\xc3", "\xe4\xb8", "\xf0\x9f", "\x80", "\x01"}) {
    EXPECT_EQ(text_width(text), 6 * static_cast<int>(text.size()) - 1) << text.size();
  }
  EXPECT_EQ(drawn("\xc3"
                  "A"),
            drawn("\u4e2d"
                  "A"));
}

TEST(BitmapTextTest, WhatLiesOutsideOfThePictureIsLeftOut) {
  Picture picture = blank(4, 4);
  draw_text("WWWW", -7, -3, 3, kInk, picture);
  draw_text("W", 100, 100, 1, kInk, picture);
  Picture large = blank(40, 40);
  draw_text("WWWW", 3, 7, 3, kInk, large);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) EXPECT_EQ(picture.at(x, y), large.at(x + 10, y + 10));
  }
}

}  // namespace
}  // namespace trapeze
