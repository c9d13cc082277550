#include "server/labels/broken_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "render/text/usual_fonts.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;

class BrokenLinesTest : public ::testing::Test {
 protected:
  BrokenLinesTest() {
    for (const std::string& file : usual_fonts()) fonts_.add(file);
  }
  double width(std::string_view text) const { return fonts_.extent_of(text).width; }

  Fonts fonts_;
};

TEST_F(BrokenLinesTest, WhatFitsIsOneLine) {
  const BrokenLines broken = broken_lines("New Zealand", 20, fonts_);
  EXPECT_THAT(broken.lines, ElementsAre("New Zealand"));
  EXPECT_DOUBLE_EQ(broken.width, width("New Zealand"));
}

TEST_F(BrokenLinesTest, LinesAreAboutEquallyWide) {
  const double most = width("Saint Vincent and the");
  EXPECT_THAT(broken_lines("Saint Vincent and the Grenadines", most, fonts_).lines,
              ElementsAre("Saint Vincent and", "the Grenadines"));
}

TEST_F(BrokenLinesTest, AWordThatIsTooLongStaysWhole) {
  const BrokenLines broken = broken_lines("the Donaudampfschifffahrt company", 5, fonts_);
  EXPECT_THAT(broken.lines, ElementsAre("the", "Donaudampfschifffahrt", "company"));
  EXPECT_DOUBLE_EQ(broken.width, width("Donaudampfschifffahrt"));
}

TEST_F(BrokenLinesTest, HyphensAndSlashesEndLines) {
  EXPECT_THAT(broken_lines("Nordrhein-Westfalen", 6, fonts_).lines,
              ElementsAre("Nordrhein-", "Westfalen"));
  EXPECT_THAT(broken_lines("forest/meadow", 5, fonts_).lines, ElementsAre("forest/", "meadow"));
}

TEST_F(BrokenLinesTest, IdeographsAreBrokenAnywhere) {
  const BrokenLines broken = broken_lines("中华人民共和国", 4, fonts_);
  EXPECT_THAT(broken.lines, ElementsAre("中华人民", "共和国"));
}

TEST_F(BrokenLinesTest, MarksStayWithTheirLetters) {
  EXPECT_THAT(broken_lines("か\u3099き\u3099", 0.5, fonts_).lines,
              ElementsAre("か\u3099", "き\u3099"));
  EXPECT_THAT(broken_lines("葛\U000E0100飾", 0.5, fonts_).lines, ElementsAre("葛\U000E0100", "飾"));
}

TEST_F(BrokenLinesTest, NoTextHasNoWidth) {
  EXPECT_EQ(broken_lines("", 10, fonts_).width, 0);
}

}  // namespace
}  // namespace trapeze
