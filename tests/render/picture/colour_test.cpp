#include "render/picture/colour.h"

#include <gtest/gtest.h>

#include <string>

namespace trapeze {

void PrintTo(Rgba colour, std::ostream* out) {
  *out << to_hex(colour);
}

namespace {

TEST(ColourTest, ReadsHexadecimalOfAllLengths) {
  EXPECT_EQ(parse_colour("1af"), (Rgba{0x11, 0xaa, 0xff, 255}));
  EXPECT_EQ(parse_colour("1af8"), (Rgba{0x11, 0xaa, 0xff, 0x88}));
  EXPECT_EQ(parse_colour("12AbF0"), (Rgba{0x12, 0xab, 0xf0, 255}));
  EXPECT_EQ(parse_colour("12abf040"), (Rgba{0x12, 0xab, 0xf0, 0x40}));
  EXPECT_EQ(parse_colour("#12abf0"), (Rgba{0x12, 0xab, 0xf0, 255}));
}

TEST(ColourTest, KnowsTheNamesOfCss) {
  EXPECT_EQ(parse_colour("aliceblue"), (Rgba{240, 248, 255, 255}));
  EXPECT_EQ(parse_colour("RebeccaPurple"), (Rgba{102, 51, 153, 255}));
  EXPECT_EQ(parse_colour("yellowgreen"), (Rgba{154, 205, 50, 255}));
  EXPECT_EQ(parse_colour("slategrey"), parse_colour("slategray"));
  EXPECT_EQ(parse_colour("transparent"), kTransparent);
}

TEST(ColourTest, ReadsTheFunctionsOfCss) {
  EXPECT_EQ(parse_colour("rgb(1,2,3)"), (Rgba{1, 2, 3, 255}));
  EXPECT_EQ(parse_colour(" rgb( 1 , 2 , 3 ) "), (Rgba{1, 2, 3, 255}));
  EXPECT_EQ(parse_colour("rgb(1 2 3)"), (Rgba{1, 2, 3, 255}));
  EXPECT_EQ(parse_colour("rgb(1 2 3/50%)"), (Rgba{1, 2, 3, 128}));
  EXPECT_EQ(parse_colour("rgba(1,2,3,.5)"), (Rgba{1, 2, 3, 128}));
  EXPECT_EQ(parse_colour("rgba(100%, 50%, 0%, 20%)"), (Rgba{255, 128, 0, 51}));
}

TEST(ColourTest, BringsNumbersIntoRangeAsCssDoes) {
  EXPECT_EQ(parse_colour("rgb(-5, 300, 12.6)"), (Rgba{0, 255, 13, 255}));
  EXPECT_EQ(parse_colour("rgba(0,0,0,7)"), (Rgba{0, 0, 0, 255}));
  EXPECT_EQ(parse_colour("rgb(0,0,1e300)"), (Rgba{0, 0, 255, 255}));
}

TEST(ColourTest, RefusesWhatIsNoColour) {
  for (const char* text : {"",
                           " ",
                           "#",
                           "12",
                           "12345",
                           "1234567",
                           "123456789",
                           "ggg",
                           "##fff",
                           "rouge",
                           "red ish",
                           "rgb",
                           "rgb(",
                           "rgb()",
                           "rgb(1,2)",
                           "rgb(1,2,3",
                           "rgb(1,2,3,4,5)",
                           "rgb(1,,3)",
                           "rgb(1 2,3)",
                           "rgb(1,2 3)",
                           "rgb(1,2%,3)",
                           "rgb(1,2,3/0.5)",
                           "rgb(1 2 3,0.5)",
                           "rgb(nan,0,0)",
                           "rgb(inf,0,0)",
                           "rgb(0x1,0,0)",
                           "rgb(+-1,0,0)",
                           "rgb(123)",
                           "hsl(1,2%,3%)",
                           "rgb(1,2,3))",
                           "r\xc3\xa9"
                           "d"}) {
    EXPECT_EQ(parse_colour(text), std::nullopt) << text;
  }
  EXPECT_EQ(parse_colour(std::string("red\0", 4)), std::nullopt);
  EXPECT_EQ(parse_colour("rgb(" + std::string(100'000, ' ') + "1,2,3)"), std::nullopt);
}

TEST(ColourTest, HexadecimalIsReadBack) {
  for (const Rgba colour : {Rgba{0, 1, 254, 255}, Rgba{16, 15, 9, 0}, Rgba{200, 100, 50, 25}}) {
    EXPECT_EQ(parse_colour(to_hex(colour)), colour);
  }
  EXPECT_EQ(to_hex({0xab, 0x0c, 0, 0xff}), "ab0c00ff");
}

TEST(ColourTest, OpacityMultiplies) {
  EXPECT_EQ(with_opacity({1, 2, 3, 255}, 0.5).a, 128);
  EXPECT_EQ(with_opacity({1, 2, 3, 128}, 0.5).a, 64);
  EXPECT_EQ(with_opacity({1, 2, 3, 128}, 0).a, 0);
}

}  // namespace
}  // namespace trapeze
