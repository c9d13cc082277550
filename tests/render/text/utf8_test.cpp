#include "render/text/utf8.h"

#include <gtest/gtest.h>

#include <string>

namespace trapeze {
namespace {

std::u32string characters(std::string_view text) {
  return characters_of_line(text, 100);
}

TEST(Utf8Test, CharactersOfEveryLengthAreRead) {
  EXPECT_EQ(characters("a\u00df\u65e5\U0001f600"), U"a\u00df\u65e5\U0001f600");
  EXPECT_EQ(characters("\x7e\u0080\u07ff\u0800\ud7ff\ue000\uffff\U00010000\U0010ffff"),
            U"\x7e\u07ff\u0800\ud7ff\ue000\uffff\U00010000\U0010ffff")
      << "at the borders of the lengths; U+0080 is a control character";
}

TEST(Utf8Test, BytesThatAreNoTextAreReplaced) {
  EXPECT_EQ(characters("a\xff"
                       "b"),
            U"a\ufffdb");
  EXPECT_EQ(characters("\x80\x80"), U"\ufffd\ufffd");
  EXPECT_EQ(characters("\xc0\xaf"), U"\ufffd\ufffd") << "longer than it has to be";
  EXPECT_EQ(characters("\xe0\x80\xaf"), U"\ufffd\ufffd\ufffd") << "longer than it has to be";
  EXPECT_EQ(characters("\xed\xa0\x80"), U"\ufffd\ufffd\ufffd") << "a surrogate";
  EXPECT_EQ(characters("\xf4\x90\x80\x80"), U"\ufffd\ufffd\ufffd\ufffd") << "beyond U+10FFFF";
}

TEST(Utf8Test, ACharacterWithoutItsEndIsReplacedOnceAndWhatFollowsIsRead) {
  EXPECT_EQ(characters("\xc3"), U"\ufffd");
  EXPECT_EQ(characters("\xe6\x97"
                       "a"),
            U"\ufffda");
  EXPECT_EQ(characters("\xf0\x9f\x98"
                       "\u00df"),
            U"\ufffd\u00df");
}

TEST(Utf8Test, ControlCharactersAreLeftOutAndEndsOfLinesAreSpaces) {
  EXPECT_EQ(characters(std::string("a\0b\x1b\x7f\u009f"
                                   "c",
                                   9)),
            U"abc");
  EXPECT_EQ(characters("a\tb\nc\u2028d"), U"a b c d");
}

TEST(Utf8Test, NoMoreIsReadThanIsWanted) {
  EXPECT_EQ(characters_of_line("abcdef", 3), U"abc");
  EXPECT_EQ(characters_of_line(std::string(1000, '\x01') + "a", 10), U"") << "nor looked at";
}

}  // namespace
}  // namespace trapeze
