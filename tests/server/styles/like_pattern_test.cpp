#include "server/styles/like_pattern.h"

#include <gmock/gmock.h>

#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace trapeze {
namespace {

bool fits(std::string_view text, std::string_view pattern) {
  return LikePattern(pattern).matches(text);
}

TEST(LikePatternTest, PercentIsAnythingAndUnderscoreOneCharacter) {
  EXPECT_TRUE(fits("", ""));
  EXPECT_TRUE(fits("", "%"));
  EXPECT_FALSE(fits("a", ""));
  EXPECT_FALSE(fits("", "_"));
  EXPECT_TRUE(fits("Z\u00fcrich", "Z_rich"));
  EXPECT_FALSE(fits("Z\u00fcrich", "Z__rich"));
  EXPECT_TRUE(fits("Z\u00fcrich", "%_rich"));
  EXPECT_TRUE(fits("Z\u00fcrich", "%Z_r%"));
  EXPECT_TRUE(fits("Z\u00fcrich", "%_\u00fc%"));
  EXPECT_FALSE(fits("aba", "ab%ba")) << "the ends do not overlap";
  EXPECT_TRUE(fits("abba", "ab%ba"));
  EXPECT_TRUE(fits("one two three", "%o%t%e"));
  EXPECT_FALSE(fits("one two three", "%t%o%o%"));
}

TEST(LikePatternTest, ABackslashTakesTheMeaning) {
  EXPECT_TRUE(fits("100%", "100\\%"));
  EXPECT_FALSE(fits("1000", "100\\%"));
  EXPECT_TRUE(fits("a_b", "%a\\_b%"));
  EXPECT_FALSE(fits("axb", "%a\\_b%"));
  EXPECT_TRUE(fits("a\\", "a\\")) << "with nothing after it, it is itself";
}

/// Matches by brute force.
bool fits_by_trying(const std::vector<std::string>& text, std::size_t t, std::string_view pattern) {
  if (pattern.empty()) return t == text.size();
  if (pattern.front() == '%') {
    for (std::size_t i = t; i <= text.size(); ++i) {
      if (fits_by_trying(text, i, pattern.substr(1))) return true;
    }
    return false;
  }
  if (t == text.size()) return false;
  const bool is_one = pattern.front() == '_' || text[t] == pattern.substr(0, 1);
  return is_one && fits_by_trying(text, t + 1, pattern.substr(1));
}

TEST(LikePatternTest, AgreesWithTryingEverything) {
  constexpr unsigned kSeed = 7;
  std::mt19937 random(kSeed);
  const std::vector<std::string> letters = {"a", "b", "\u00e4", "\u20ac"};
  constexpr std::string_view kSigns = "aabb_%";
  int fitting = 0;
  for (int i = 0; i < 50'000; ++i) {
    std::vector<std::string> text(random() % 9);
    std::string whole;
    for (std::string& letter : text) whole += letter = letters[random() % letters.size()];
    std::string pattern(random() % 8, ' ');
    for (char& sign : pattern) sign = kSigns[random() % kSigns.size()];
    const bool expected = fits_by_trying(text, 0, pattern);
    ASSERT_EQ(fits(whole, pattern), expected) << whole << " LIKE " << pattern;
    fitting += expected;
  }
  EXPECT_GT(fitting, 1000);
}

TEST(LikePatternTest, PartsAreAsLongAsTheyLike) {
  const std::string text = std::string(3000, 'a') + "b" + std::string(3000, 'a');
  for (const std::size_t length : {62, 63, 64, 65, 127, 128, 129, 1000}) {
    const std::string as(length, 'a');
    EXPECT_TRUE(fits(text, "%_" + as + "b%")) << length;
    EXPECT_TRUE(fits(text, "%" + as + "_" + as + "%")) << length;
    EXPECT_FALSE(fits(text, "%_" + as + "bb%")) << length;
    EXPECT_TRUE(fits(text, "%" + as + "b" + as + "%")) << length;
  }
}

// In time proportional to the product of both lengths these would take minutes.
TEST(LikePatternTest, LongTextsTakeTimeOfTheirLength) {
  const std::string text(std::size_t{32} << 20, 'a');
  const std::string as(900, 'a');
  EXPECT_FALSE(fits(text, "%" + as + "b"));
  EXPECT_FALSE(fits(text, "%" + as + "b%"));
  EXPECT_FALSE(fits(text, "%" + as + "_b%"));
  EXPECT_FALSE(fits(text, "%a%" + as + "_%b%a"));
}

}  // namespace
}  // namespace trapeze
