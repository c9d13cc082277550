#include "render/text/fonts.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "render/text/usual_fonts.h"
#include "render/text/utf8.h"
#include "tests/core/io/temporary_folder.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;

constexpr Rgba kWhite{255, 255, 255, 255};
constexpr Rgba kInk{0, 0, 0, 255};
constexpr int kTextSize = 24;

/// The file of the usual font with that name; empty if it is not installed.
std::string font_file(std::string_view name) {
  const auto files = usual_fonts();
  const auto found = std::ranges::find_if(
      files, [name](const std::string& file) { return file.find(name) != std::string::npos; });
  return found == files.end() ? std::string() : *found;
}

/// The usual font with that name, or else the file, which script/bootstrap installs; empty if
/// neither is there.
std::string font_file_or(std::string_view name, const char* file) {
  const std::string usual = font_file(name);
  if (!usual.empty()) return usual;
  return std::filesystem::exists(file) ? file : std::string();
}

std::string dejavu() {
  const std::string file = font_file("/DejaVuSans.ttf");
  if (file.empty()) throw std::runtime_error("these tests need fonts-dejavu-core");
  return file;
}

/// Darkness of ink, 0 to 255, row by row.
struct Drawing {
  int width = 0;
  std::vector<int> values;

  int at(int x, int y) const {
    return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  long ink() const {
    long sum = 0;
    for (const int value : values) sum += value;
    return sum;
  }
  /// The ink in `count` columns, starting at column `from`.
  long ink_of(int from, int count) const {
    long sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const int x = static_cast<int>(i) % width;
      if (x >= from && x < from + count) sum += values[i];
    }
    return sum;
  }

  friend bool operator==(const Drawing&, const Drawing&) = default;
};

constexpr int kHeight = 2 * kTextSize;
constexpr int kBase = kTextSize + kTextSize / 2;

Picture blank(int width, int height) {
  Picture picture;
  picture.width = width;
  picture.height = height;
  picture.pixels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kWhite);
  return picture;
}

class FontsTest : public ::testing::Test {
 protected:
  FontsTest() { fonts_.add(dejavu()); }

  static Drawing drawn_by(const Fonts& fonts, std::string_view line) {
    Picture picture = blank(std::max(1, fonts.width_of(line, kTextSize)), kHeight);
    fonts.draw(line, 0, kBase, {kTextSize, kInk}, picture);
    Drawing drawing{picture.width, {}};
    for (const Rgba pixel : picture.pixels) drawing.values.push_back(255 - pixel.r);
    return drawing;
  }
  Drawing drawn(std::string_view line) const { return drawn_by(fonts_, line); }
  int width(std::string_view line) const { return fonts_.width_of(line, kTextSize); }

  Fonts fonts_;
};

TEST_F(FontsTest, AccentsAreDrawn) {
  for (const auto& [accented, plain] : std::vector<std::pair<std::string, std::string>>{
           {"\u00f6", "o"}, {"\u00f1", "n"}, {"\u00da", "U"}, {"\u0159", "r"}, {"\u1ea5", "a"}}) {
    EXPECT_GT(drawn(accented).ink(), drawn(plain).ink()) << accented;
  }
  EXPECT_NE(drawn("\u00df"), drawn("s"));
}

TEST_F(FontsTest, AnAccentThatFollowsItsLetterIsDrawnOverIt) {
  EXPECT_EQ(width("e\u0301"), width("e"));
  EXPECT_EQ(drawn("e\u0301"), drawn("\u00e9"));
  EXPECT_EQ(width("x\u0323\u0302"), width("x")) << "there is no such letter";
  EXPECT_GT(drawn("x\u0323\u0302").ink(), drawn("x").ink());
}

TEST_F(FontsTest, LettersAreAntialiased) {
  const Drawing drawing = drawn("S");
  const auto grey =
      std::ranges::count_if(drawing.values, [](int value) { return value > 20 && value < 235; });
  EXPECT_GT(grey, 10);
  EXPECT_TRUE(std::ranges::any_of(drawing.values, [](int value) { return value == 255; }));
}

TEST_F(FontsTest, EveryLetterOfAsciiDiffersFromEveryOther) {
  for (char a = '!'; a < 127; ++a) {
    for (char b = '!'; b < a; ++b) EXPECT_NE(drawn({&a, 1}), drawn({&b, 1})) << a << b;
  }
}

TEST_F(FontsTest, LettersStandOnTheBaseLine) {
  const Drawing drawing = drawn("H");
  long below = 0;
  for (int y = kBase; y < kHeight; ++y) {
    for (int x = 0; x < drawing.width; ++x) below += drawing.at(x, y);
  }
  EXPECT_EQ(below, 0);
  int foot = 0;
  for (int x = 0; x < drawing.width; ++x) foot = std::max(foot, drawing.at(x, kBase - 1));
  EXPECT_EQ(foot, 255);
}

TEST_F(FontsTest, WidthsOfWordsAddUp) {
  for (const auto& [a, b] : std::vector<std::pair<std::string, std::string>>{
           {"Haus", " und Hof"}, {"Gr\u00f6\u00dfe ", "Nandu"}, {"\u05e9\u05dc", "\u05d5\u05dd"}}) {
    EXPECT_NEAR(width(a + b), width(a) + width(b), 2) << a << b;
  }
  EXPECT_EQ(width(""), 0);
}

TEST_F(FontsTest, WidthsGrowInProportionToTheSize) {
  const std::string line = "Gr\u00f6\u00dfe Nandu \u0627\u0644\u0639\u0631\u0628\u064a\u0629";
  const int once = fonts_.width_of(line, 12);
  for (int scale = 2; scale <= 4; ++scale) {
    EXPECT_NEAR(fonts_.width_of(line, 12 * scale), once * scale, 2 * scale) << scale;
  }
}

TEST_F(FontsTest, ArabicLettersAreJoined) {
  const std::string beh = "\u0628";
  const std::string apart = beh + "\u200c" + beh + "\u200c" + beh;  // zero width non-joiner
  EXPECT_LT(width(beh + beh + beh), width(apart) - 3) << "forms of letters that stand alone";
  // Joined on the baseline: every column between the first and the last letter has ink.
  const Drawing joined = drawn(beh + beh + beh);
  for (int x = 3; x + 3 < joined.width; ++x) EXPECT_GT(joined.ink_of(x, 1), 0) << x;
  EXPECT_LT(width("\u0644\u0627"), width("\u0644") + width("\u0627"))
      << "lam and alef are one sign";
}

TEST_F(FontsTest, HebrewRunsFromRightToLeft) {
  const std::string wide = "\u05e9";    // shin
  const std::string narrow = "\u05d9";  // yod
  const Drawing line = drawn(wide + narrow);
  const int left = width(narrow);
  EXPECT_NEAR(static_cast<double>(line.ink_of(0, left)), static_cast<double>(drawn(narrow).ink()),
              0.1 * static_cast<double>(line.ink()))
      << "the second letter is the left one";
}

TEST_F(FontsTest, NumbersWithinHebrewRunFromLeftToRight) {
  const std::string alef = "\u05d0";
  const Drawing line = drawn(alef + " 17");
  const Drawing number = drawn("17");
  const Drawing reversed = drawn("71");
  const auto first_columns = [&](const Drawing& drawing) {
    std::vector<int> values;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < number.width - 1; ++x) values.push_back(drawing.at(x, y));
    }
    return values;
  };
  EXPECT_EQ(first_columns(line), first_columns(number));
  EXPECT_NE(first_columns(line), first_columns(reversed));
}

TEST_F(FontsTest, ALineThatBeginsInLatinRunsFromLeftToRight) {
  const Drawing line = drawn("W \u05d9");
  EXPECT_NEAR(static_cast<double>(line.ink_of(0, width("W"))),
              static_cast<double>(drawn("W").ink()), 300);
  const Drawing other = drawn("\u05d9 W");
  EXPECT_NEAR(static_cast<double>(other.ink_of(0, width("W"))),
              static_cast<double>(drawn("W").ink()), 300)
      << "begun by Hebrew it runs from right to left";
}

TEST_F(FontsTest, DevanagariIsCombined) {
  if (font_file("Devanagari").empty()) GTEST_SKIP() << "fonts-noto-core is not installed";
  fonts_.add(font_file("Devanagari"));
  const std::string ka = "\u0915";
  const std::string virama = "\u094d";
  const std::string ssa = "\u0937";
  EXPECT_LT(width(ka + virama + ssa), width(ka) + width(ssa) - 3) << "a conjunct";
  // The vowel sign i is written to the left of the consonant that it follows.
  const Drawing alone = drawn(ka);
  const Drawing ki = drawn(ka + "\u093f");
  const auto foot_of_last_columns = [&](const Drawing& drawing) {
    double ink = 0;
    for (int y = kBase - kTextSize / 3; y < kHeight; ++y) {
      for (int x = drawing.width - alone.width; x < drawing.width; ++x) ink += drawing.at(x, y);
    }
    return ink;
  };
  EXPECT_GT(ki.width, alone.width);
  EXPECT_NEAR(foot_of_last_columns(ki), foot_of_last_columns(alone),
              0.1 * foot_of_last_columns(alone))
      << "the consonant is the right one";
}

TEST_F(FontsTest, ThaiMarksStandOverTheirLetters) {
  const std::string file = font_file_or("Thai", "/usr/share/fonts/truetype/tlwg/Loma.ttf");
  if (file.empty()) GTEST_SKIP() << "neither fonts-noto-core nor fonts-tlwg-loma-ttf is installed";
  fonts_.add(file);
  EXPECT_EQ(width("\u0e01\u0e35\u0e49"), width("\u0e01"));
  EXPECT_GT(drawn("\u0e01\u0e35\u0e49").ink(), drawn("\u0e01").ink());
}

TEST_F(FontsTest, WhatTheFirstFontLacksIsDrawnInTheNextOne) {
  const std::string han = "\u65e5\u672c";
  const Drawing boxes = drawn(han);
  const std::string file =
      font_file_or("CJK", "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf");
  if (file.empty()) GTEST_SKIP() << "neither fonts-noto-cjk nor fonts-droid-fallback is installed";
  const Drawing latin = drawn("Tag");
  fonts_.add(file);
  EXPECT_NE(drawn(han), boxes);
  EXPECT_EQ(width(han), 2 * kTextSize) << "Han characters are squares";
  EXPECT_EQ(drawn("Tag"), latin) << "what the first font has stays with it";
}

TEST_F(FontsTest, ACharacterInNoFontIsABox) {
  const Drawing box = drawn("\u65e5");
  EXPECT_GT(box.ink(), 0);
  EXPECT_EQ(drawn("\u672c"), box);
  EXPECT_NEAR(width("\u65e5\u672c"), 2 * width("\u65e5"), 1);
}

TEST_F(FontsTest, ALetterAndItsMarkAreOfOneFont) {
  const std::string file = font_file("NotoSans-Regular");
  if (file.empty()) GTEST_SKIP() << "fonts-noto-core is not installed";
  // DejaVu Sans has no U+1DCA, Noto Sans has it and the letter.
  const std::string marked = "o\u1dca";
  Fonts noto;
  noto.add(file);
  ASSERT_NE(drawn("o"), drawn_by(noto, "o"));
  fonts_.add(file);
  EXPECT_EQ(drawn(marked), drawn_by(noto, marked));
}

TEST_F(FontsTest, BytesThatAreNoTextAreDrawnAsTheSignForThat) {
  EXPECT_EQ(drawn("a\xff"
                  "b"),
            drawn("a\ufffd"
                  "b"));
  EXPECT_EQ(drawn("\xe6\x97"), drawn("\ufffd"));
}

TEST_F(FontsTest, ControlCharactersAreNotDrawn) {
  EXPECT_EQ(drawn("a\x01\x1b"
                  "b\x7f"),
            drawn("ab"));
  EXPECT_EQ(drawn("a\nb"), drawn("a b"));
  EXPECT_EQ(width("\u202e\u202c\u2066\u2069\u200f\ufeff"), 0) << "marks of direction have no width";
}

TEST_F(FontsTest, TheWorkForALineIsBoundedHoweverLongItIs) {
  const auto begin = std::chrono::steady_clock::now();
  const std::string longest(Fonts::kMostCharacters, 'm');
  const std::string longer(std::size_t{8} << 20, 'm');
  EXPECT_EQ(width(longer), width(longest));
  std::string mixed;
  while (mixed.size() < 100'000) mixed += "a\u05d0\u202e\u0301\u0628\xff";
  EXPECT_LE(width(fonts_.fitted(mixed, kTextSize, 500)), 500);
  Picture picture = blank(100, 30);
  fonts_.draw(mixed, 0, 20, {kTextSize, kInk}, picture);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST_F(FontsTest, AFittedLineIsTheLineIfItFits) {
  EXPECT_EQ(fonts_.fitted("Haus", kTextSize, width("Haus")), "Haus");
  EXPECT_EQ(fonts_.fitted("", kTextSize, 0), "");
}

TEST_F(FontsTest, AFittedLineIsTheLongestBeginningWithAnEllipsis) {
  const std::string line = "Gr\u00f6\u00dfenverh\u00e4ltnisse";
  for (int most = width("\u2026"); most < width(line); most += 7) {
    const std::string fitted = fonts_.fitted(line, kTextSize, most);
    EXPECT_LE(width(fitted), most);
    ASSERT_TRUE(fitted.ends_with("\u2026")) << fitted;
    const std::string begin = fitted.substr(0, fitted.size() - std::string("\u2026").size());
    EXPECT_TRUE(line.starts_with(begin)) << fitted;
    EXPECT_EQ(characters_of_line(begin, 100).find(U'\ufffd'), std::u32string::npos)
        << "characters are kept whole";
    std::size_t next = begin.size() + 1;
    while ((static_cast<unsigned char>(line[next]) & 0xc0) == 0x80) ++next;
    EXPECT_GT(width(line.substr(0, next) + "\u2026"), most) << "one more would not have fitted";
  }
}

TEST_F(FontsTest, WhatLiesOutsideOfThePictureIsLeftOut) {
  Picture picture = blank(8, 8);
  fonts_.draw("WWWW", -15, 12, {kTextSize, kInk}, picture);
  fonts_.draw("W", 100, 100, {kTextSize, kInk}, picture);
  fonts_.draw("W", -100, -100, {kTextSize, kInk}, picture);
  Picture large = blank(200, 60);
  fonts_.draw("WWWW", 5, 32, {kTextSize, kInk}, large);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) EXPECT_EQ(picture.at(x, y), large.at(x + 20, y + 20));
  }
}

TEST_F(FontsTest, TextIsLaidOverWhatIsThereInItsColour) {
  Picture picture = blank(kTextSize, kHeight);
  std::ranges::fill(picture.pixels, Rgba{0, 0, 255, 255});
  fonts_.draw("\u2588", 0, kBase, {kTextSize, {255, 0, 0, 128}}, picture);  // full block
  EXPECT_EQ(picture.at(kTextSize / 3, kBase - 5), (Rgba{128, 0, 127, 255}));
}

/// Lines in every script with its own rules for combining or ordering, where a font is installed.
std::vector<std::string> lines_of_scripts() {
  std::vector<std::string> lines = {"Stra\u00dfe", "\u0395\u03bb\u03bb\u03ac\u03b4\u03b1",
                                    "\u0623\u0641\u063a\u0627\u0646\u0633\u062a\u0627\u0646",
                                    "\u05d9\u05e9\u05e8\u05d0\u05dc 12"};
  if (!font_file("Devanagari").empty()) lines.emplace_back("\u0939\u093f\u0928\u094d\u0926\u0940");
  if (!font_file("Thai").empty()) lines.emplace_back("\u0e17\u0e35\u0e48\u0e19\u0e35\u0e48");
  if (!font_file("CJK").empty()) lines.emplace_back("\u4e2d\u56fd");
  return lines;
}

TEST_F(FontsTest, AMaskHasTheLettersOfTheLineInItsMiddle) {
  Fonts fonts;
  for (const std::string& file : usual_fonts()) fonts.add(file);
  for (const std::string& line : lines_of_scripts()) {
    const Drawing drawing = drawn_by(fonts, line);
    const int side = drawing.width + 40 + drawing.width % 2;
    const TextMask mask =
        fonts.mask_of(std::vector<std::string>{line}, kTextSize, kTextSize, 2, side, 80);
    ASSERT_EQ(mask.width, side);
    long letters = 0;
    double moment = 0;
    for (std::size_t i = 0; i < mask.letters.size(); ++i) {
      EXPECT_GE(mask.halo[i], mask.letters[i]);
      letters += mask.letters[i];
      moment += mask.letters[i] * static_cast<double>(i % static_cast<std::size_t>(side));
    }
    // The same ink, except for rounding steps and the position of columns.
    EXPECT_NEAR(static_cast<double>(letters), static_cast<double>(drawing.ink()),
                0.04 * static_cast<double>(drawing.ink()))
        << line;
    EXPECT_NEAR(moment / static_cast<double>(letters), side / 2.0, 0.12 * side) << line;
  }
}

TEST_F(FontsTest, TheHaloReachesAsFarAsItIsWide) {
  const TextMask thin =
      fonts_.mask_of(std::vector<std::string>{"H"}, kTextSize, kTextSize, 0, 60, 60);
  const TextMask wide =
      fonts_.mask_of(std::vector<std::string>{"H"}, kTextSize, kTextSize, 4, 60, 60);
  EXPECT_EQ(thin.letters, wide.letters);
  EXPECT_EQ(thin.halo, thin.letters);
  const auto near_letter = [&thin](int column, int row, int reach) {
    for (int y = row - reach; y <= row + reach; ++y) {
      for (int x = column - reach; x <= column + reach; ++x) {
        if (x < 0 || y < 0 || x >= 60 || y >= 60) continue;
        if (thin.letters[static_cast<std::size_t>(y * 60 + x)] > 0) return true;
      }
    }
    return false;
  };
  for (int row = 0; row < 60; ++row) {
    for (int column = 0; column < 60; ++column) {
      const auto value = wide.halo[static_cast<std::size_t>(row * 60 + column)];
      if (!near_letter(column, row, 5)) {
        EXPECT_EQ(value, 0);
      }
      if (near_letter(column, row, 2)) {
        EXPECT_EQ(value, 255);
      }
    }
  }
}

TEST_F(FontsTest, AnExtentIsTheWidthOfTheLine) {
  Fonts fonts;
  for (const std::string& file : usual_fonts()) fonts.add(file);
  for (const std::string& line : lines_of_scripts()) {
    const double pixels = fonts.extent_of(line).width * kTextSize;
    EXPECT_NEAR(pixels, fonts.width_of(line, kTextSize), 0.05 * pixels + 1) << line;
  }
  EXPECT_GT(fonts.extent_of("\u0e17\u0e35\u0e48").height, fonts.extent_of("a").height);
  EXPECT_EQ(fonts.extent_of("").width, 0);
}

TEST_F(FontsTest, AMaskCutsOffWhatReachesOutOfIt) {
  const TextMask mask =
      fonts_.mask_of(std::vector<std::string>{"WWWWWWWW", "W"}, kTextSize, kTextSize, 3, 20, 10);
  EXPECT_EQ(mask.letters.size(), 200u);
  EXPECT_TRUE(std::ranges::any_of(mask.letters, [](auto value) { return value > 0; }));
}

TEST_F(FontsTest, ThreadsDrawTheSameAtTheSameTime) {
  const std::string line = "Gr\u00f6\u00dfe \u0627\u0644\u0639\u0631\u0628\u064a\u0629";
  const Drawing expected = drawn(line);
  std::vector<int> different(4);
  std::vector<std::thread> threads;
  for (int& count : different) {
    threads.emplace_back([&, size = 10 + static_cast<int>(&count - different.data())] {
      for (int i = 0; i < 25; ++i) {
        fonts_.width_of(line, size);
        count += drawn(line) == expected ? 0 : 1;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(different, ::testing::Each(0));
}

TEST(NoFontsTest, WithoutAFontNothingIsDrawnAndNothingBreaks) {
  const Fonts none;
  EXPECT_TRUE(none.is_empty());
  EXPECT_EQ(none.width_of("Haus", 12), 0);
  EXPECT_EQ(none.fitted("Haus", 12, 10), "Haus");
  Picture picture = blank(20, 20);
  none.draw("Haus", 0, 15, {12, kInk}, picture);
  EXPECT_TRUE(std::ranges::all_of(picture.pixels, [](Rgba pixel) { return pixel == kWhite; }));
}

class FontFilesTest : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& bytes) const {
    return folder_.write(name, bytes);
  }
  static std::string dejavu_bytes() {
    std::ifstream file(dejavu(), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  /// Empty if the font can be used.
  static std::string fault_of(const std::string& file) {
    try {
      Fonts().add(file);
      return {};
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  }

  const TemporaryFolder folder_;
};

TEST_F(FontFilesTest, WhatIsWrongWithAFontIsSaidWithTheNameOfItsFile) {
  EXPECT_EQ(fault_of("/nowhere/a.ttf"), "the font /nowhere/a.ttf is not there");
  EXPECT_THAT(fault_of(folder_.file("")), HasSubstr("is not there")) << "a folder";
  const std::string words = write("words.ttf", "these are words");
  EXPECT_EQ(fault_of(words), "the font " + words + " is in no format of fonts that is known");
  EXPECT_THAT(fault_of(write("empty.ttf", "")), HasSubstr("empty.ttf is "));
  EXPECT_THAT(fault_of(dejavu() + "#7"), HasSubstr("has no font of that number"));
}

TEST_F(FontFilesTest, AFontThatIsCutShortIsRefused) {
  const std::string bytes = dejavu_bytes();
  for (const int share : {1, 10, 50}) {
    const std::string cut =
        write("cut.ttf", bytes.substr(0, bytes.size() * static_cast<std::size_t>(share) / 100));
    EXPECT_THAT(fault_of(cut), HasSubstr("cut.ttf")) << share << " % of it";
  }
}

TEST_F(FontFilesTest, AFontThatIsRefusedLeavesTheOthers) {
  Fonts fonts;
  fonts.add(dejavu());
  const int before = fonts.width_of("Haus", 12);
  EXPECT_THROW(fonts.add(write("words.ttf", "these are words")), std::runtime_error);
  EXPECT_EQ(fonts.width_of("Haus", 12), before);
}

TEST_F(FontFilesTest, ANumberNamesAFontOfACollection) {
  EXPECT_EQ(fault_of(dejavu() + "#0"), "");
  const std::string named = write("a#b.ttf", dejavu_bytes());
  EXPECT_EQ(fault_of(named), "") << "a sign within a name";
}

}  // namespace
}  // namespace trapeze
