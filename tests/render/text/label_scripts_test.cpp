// Labels in scripts whose letters change beside each other, run from right to left or are combined.
// Each is compared with a reference picture in the folder pictures, checked by eye.
//
// With TRAPEZE_DRAW_SCRIPTS=FOLDER the pictures are written there instead.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <ostream>
#include <string>
#include <vector>

#include "render/picture/picture.h"
#include "render/picture/png.h"
#include "render/text/fonts.h"

namespace trapeze {
namespace {

// Edges may differ a little between versions of FreeType.
constexpr int kMostOff = 48;               // of 255, in a pixel
constexpr double kMostOffAtTheMean = 1.5;  // of 255

struct Script {
  const char* name;
  const char* font;     // the font file
  const char* package;  // the Debian package that contains it
  std::vector<std::string> lines;

  friend std::ostream& operator<<(std::ostream& out, const Script& script) {
    return out << script.name;
  }
};

const std::vector<Script>& scripts() {
  static const std::vector<Script> all = {
      // Letters are joined, lam and alif into one sign; numbers run from left to right.
      {"arabic",
       "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
       "fonts-dejavu-core",
       {"\u0627\u0644\u0639\u0631\u0627\u0642 2024",
        "\u0633\u0644\u0627\u0645 (\u062c\u0632\u0631)"}},
      {"hebrew",
       "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
       "fonts-dejavu-core",
       {"\u05d9\u05e9\u05e8\u05d0\u05dc 12", "\u05d1\u05b0\u05bc\u05e8\u05b5\u05d0 (B)"}},
      // A vowel sign is written before its consonant; consonants are combined.
      {"devanagari",
       "/usr/share/fonts/truetype/lohit-devanagari/Lohit-Devanagari.ttf",
       "fonts-lohit-deva",
       {"\u0939\u093f\u0928\u094d\u0926\u0940", "\u0915\u094d\u0937\u0947\u0924\u094d\u0930"}},
      // Vowels and tone marks are stacked.
      {"thai",
       "/usr/share/fonts/truetype/tlwg/Loma.ttf",
       "fonts-tlwg-loma-ttf",
       {"\u0e1b\u0e23\u0e30\u0e40\u0e17\u0e28\u0e44\u0e17\u0e22",
        "\u0e19\u0e49\u0e33\u0e1b\u0e48\u0e32\u0e17\u0e35\u0e48"}},
      {"chinese",
       "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf",
       "fonts-droid-fallback",
       {"\u4e2d\u534e\u4eba\u6c11", "\u5171\u548c\u56fd\u3001\u5317\u4eac"}}};
  return all;
}

std::string picture_of(const Script& script) {
  return (std::filesystem::path(__FILE__).parent_path() / "pictures" /
          (std::string(script.name) + ".png"))
      .string();
}

Picture drawn(const Script& script) {
  constexpr double kSize = 32;
  Fonts fonts;
  fonts.add(script.font);
  const TextMask mask = fonts.mask_of(script.lines, kSize, 1.4 * kSize, 3, 256, 128);
  Picture picture{mask.width, mask.height, {}};
  for (std::size_t i = 0; i < mask.letters.size(); ++i) {
    // Dark letters on a light halo on grey.
    const int light = 128 + mask.halo[i] * 127 / 255;
    const auto grey = static_cast<std::uint8_t>(light - light * mask.letters[i] / 255);
    picture.pixels.push_back({grey, grey, grey, 255});
  }
  return picture;
}

class LabelScriptsTest : public ::testing::TestWithParam<Script> {};

TEST_P(LabelScriptsTest, LookAsTheyShould) {
  const Script& script = GetParam();
  if (!std::filesystem::exists(script.font)) GTEST_SKIP() << script.package << " is not installed";
  const Picture now = drawn(script);
  if (const char* folder = std::getenv("TRAPEZE_DRAW_SCRIPTS")) {
    const std::string png = PngEncoder().encode(to_runs(now));
    std::ofstream(std::filesystem::path(folder) / (std::string(script.name) + ".png")) << png;
    return;
  }
  std::ifstream file(picture_of(script), std::ios::binary);
  const Picture right = decode_png(std::string(std::istreambuf_iterator<char>(file), {}));
  ASSERT_EQ(now.width, right.width);
  ASSERT_EQ(now.height, right.height);
  double sum = 0;
  int most = 0;
  for (std::size_t i = 0; i < now.pixels.size(); ++i) {
    const int off = std::abs(now.pixels[i].r - right.pixels[i].r);
    sum += off;
    most = std::max(most, off);
  }
  EXPECT_LE(most, kMostOff);
  EXPECT_LE(sum / static_cast<double>(now.pixels.size()), kMostOffAtTheMean);
}

TEST_P(LabelScriptsTest, CanBeWritten) {
  const Script& script = GetParam();
  if (!std::filesystem::exists(script.font)) GTEST_SKIP() << script.package << " is not installed";
  Fonts fonts;
  EXPECT_FALSE(fonts.can_write(script.lines[0])) << "there is no font";
  fonts.add(script.font);
  for (const std::string& line : script.lines) EXPECT_TRUE(fonts.can_write(line)) << line;
  EXPECT_FALSE(fonts.can_write(script.lines[0] + " \U00013000")) << "a hieroglyph";
}

INSTANTIATE_TEST_SUITE_P(Scripts, LabelScriptsTest, ::testing::ValuesIn(scripts()),
                         [](const auto& named) { return named.param.name; });

}  // namespace
}  // namespace trapeze
