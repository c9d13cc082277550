#include "server/documents/legend.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include <set>
#include <string>
#include <vector>

#include "render/picture/png.h"
#include "server/tiles/open_fonts.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

SiteOptions with_usual_fonts() {
  SiteOptions options;
  options.fonts = open_fonts({});
  return options;
}

class LegendTest : public ::testing::Test {
 protected:
  nlohmann::json json(const std::string& target) {
    return nlohmann::json::parse(*sample_.get(target).body);
  }
  Picture picture(const std::string& target) {
    const auto response = sample_.get(target);
    EXPECT_EQ(response.header("Content-Type"), "image/png");
    return decode_png(*response.body);
  }

  /// The pixels of the swatch in a row of the picture, starting in the north-west.
  static std::vector<Rgba> swatch(const Picture& picture, int row, int scale = 1) {
    std::vector<Rgba> pixels;
    for (int y = 0; y < 12 * scale; ++y) {
      for (int x = 0; x < 20 * scale; ++x) {
        pixels.push_back(picture.at(6 * scale + x, (6 + 16 * row + 2) * scale + y));
      }
    }
    return pixels;
  }
  static Rgba pixel_of(const std::vector<Rgba>& swatch, int x, int y) {
    return swatch[static_cast<std::size_t>(y * 20 + x)];
  }

  testing::SampleSite sample_{true, {}, with_usual_fonts()};
};

TEST_F(LegendTest, NamesTheLayersTopmostFirstWithTheirColours) {
  const auto json = this->json("/legend/rings,west.json?rings.fill=lime");
  ASSERT_EQ(json["layers"].size(), 2u);
  EXPECT_EQ(json["layers"][0]["name"], "west");
  EXPECT_EQ(json["layers"][0]["entries"][0]["fill"], "#0000ff");
  EXPECT_NEAR(json["layers"][0]["entries"][0]["fill-opacity"], 0.5, 0.01);
  EXPECT_EQ(json["layers"][1]["title"], "Rings");
  EXPECT_EQ(json["layers"][1]["entries"][0]["label"], "Rings");
  EXPECT_EQ(json["layers"][1]["entries"][0]["fill"], "#00ff00");
}

TEST_F(LegendTest, ALayerOfOneColourIsPartedFromTheClassesAboveIt) {
  const int one_colour_each = picture("/legend/rings,west.png").height;
  const std::string classes = "?rings.color-by=name&rings.classes=small:00f";
  EXPECT_EQ(picture("/legend/rings.png").height, 16 + 12);
  EXPECT_EQ(one_colour_each, 2 * 16 + 12);
  // A title, the class and "others", then the other layer below them.
  const Picture parted = picture("/legend/west,rings.png" + classes);
  EXPECT_EQ(parted.height, 4 * 16 + 8 + 12);
  EXPECT_EQ(parted.at(16, 6 + 3 * 16 + 4), (Rgba{255, 255, 255, 255}));
  EXPECT_EQ(parted.at(16, 6 + 3 * 16 + 8 + 8), (Rgba{127, 127, 255, 255}));
}

TEST_F(LegendTest, ThePictureShowsTheColoursOnWhite) {
  const Picture picture = this->picture("/legend/rings,west.png");
  EXPECT_EQ(picture.at(0, 0), (Rgba{255, 255, 255, 255}));
  EXPECT_EQ(picture.at(16, 14), (Rgba{127, 127, 255, 255})) << "half opaque blue on white";
  EXPECT_EQ(picture.at(16, 30), (Rgba{255, 0, 0, 255}));
  const Picture twice = this->picture("/legend/rings,west@2x.png");
  EXPECT_EQ(twice.width, 2 * picture.width);
  EXPECT_EQ(twice.height, 2 * picture.height);
}

TEST_F(LegendTest, LabelsOfEveryScriptDiffer) {
  std::set<std::string> seen;
  const std::vector<std::string> names = {"Gr%C3%B6%C3%9Fe", "Grose", "%D8%B9%D8%B1%D8%A8",
                                          "%D8%A8%D8%B1%D8%B9", "%D7%A2%D7%91"};
  for (const std::string& name : names) {
    const auto response = sample_.get("/legend/rings.png?color-by=name&classes=" + name + ":red");
    ASSERT_EQ(response.status, 200);
    seen.insert(*response.body);
  }
  EXPECT_EQ(seen.size(), names.size());
}

TEST_F(LegendTest, LabelsThatAreTooWideEndBeforeTheBorder) {
  const std::string label(300, 'W');
  const Picture picture =
      this->picture("/legend/rings.png?color-by=name&classes=" + label + ":red");
  EXPECT_LE(picture.width, 6 + 20 + 6 + 320 + 6);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = picture.width - 5; x < picture.width; ++x) {
      EXPECT_EQ(picture.at(x, y), (Rgba{255, 255, 255, 255}));
    }
  }
}

TEST_F(LegendTest, WithoutAFontColoursAreShownAndNoText) {
  testing::SampleSite mute;
  const auto response = mute.get("/legend/rings,west.png");
  ASSERT_EQ(response.status, 200);
  const Picture picture = decode_png(*response.body);
  EXPECT_EQ(picture.width, 6 + 20 + 6 + 6);
  EXPECT_EQ(swatch(picture, 1), swatch(this->picture("/legend/rings,west.png"), 1));
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 27; x < picture.width; ++x) {
      EXPECT_EQ(picture.at(x, y), (Rgba{255, 255, 255, 255}));
    }
  }
}

TEST_F(LegendTest, PatternsAreShown) {
  std::set<std::string> seen;
  for (const char* pattern : {"none", "checker", "crosshatch", "dots", "hatch", "stripes"}) {
    const Picture picture = this->picture(
        std::string("/legend/rings.png?fill=lime&pattern-color=blue&pattern=") + pattern);
    const auto pixels = swatch(picture, 0);
    std::string text;
    int blue = 0;
    for (int i = 0; i < 16 * 8; ++i) {
      const Rgba pixel = pixel_of(pixels, 2 + i % 16, 2 + i / 16);
      text += to_hex(pixel);
      blue += pixel.b > 100 ? 1 : 0;
    }
    seen.insert(text);
    EXPECT_EQ(blue > 0, pattern != std::string("none")) << pattern;
    EXPECT_NE(text.find("00ff00"), std::string::npos) << pattern;
  }
  EXPECT_EQ(seen.size(), 6u);
}

TEST_F(LegendTest, OutlinesAreAsWideAsInTheMap) {
  constexpr Rgba kLime{0, 255, 0, 255};
  constexpr Rgba kBlue{0, 0, 255, 255};
  for (const int width : {1, 2, 3}) {
    const auto pixels = swatch(
        picture("/legend/rings.png?fill=lime&stroke=blue&stroke-width=" + std::to_string(width)),
        0);
    for (int x = 0; x < 10; ++x) {
      EXPECT_EQ(pixel_of(pixels, x, 6), x < width ? kBlue : kLime) << width << ", " << x;
    }
  }
  const auto wide = swatch(picture("/legend/rings.png?fill=lime&stroke=blue&stroke-width=30"), 0);
  EXPECT_EQ(pixel_of(wide, 3, 6), kBlue);
  EXPECT_EQ(pixel_of(wide, 4, 6), kLime) << "something of the fill is left";
}

TEST_F(LegendTest, OutlinesAreDashedAsInTheMap) {
  const auto pixels = swatch(
      picture("/legend/rings.png?fill=lime&stroke=blue&stroke-width=2&stroke-dasharray=4,4"), 0);
  int dashes = 0;
  for (int x = 2; x < 18; ++x) {
    const auto is_blue = [&](int column) {
      return pixel_of(pixels, column, 0) == Rgba{0, 0, 255, 255};
    };
    dashes += is_blue(x) && !is_blue(x - 1) ? 1 : 0;
  }
  EXPECT_EQ(dashes, 2);
}

TEST_F(LegendTest, TheOpacityOfALayerHoldsForItsWholeSwatch) {
  const auto pixels =
      swatch(picture("/legend/rings.png?fill=lime&stroke=blue&stroke-width=2&opacity=0.5"), 0);
  EXPECT_EQ(pixel_of(pixels, 0, 6), (Rgba{128, 128, 255, 255}));
  EXPECT_EQ(pixel_of(pixels, 10, 6), (Rgba{128, 255, 128, 255}));
}

TEST_F(LegendTest, WhatIsWrongIsSaid) {
  EXPECT_EQ(sample_.get("/legend/nosuch.json").status, 404);
  EXPECT_EQ(sample_.get("/legend/nosuch.png").status, 404);
  EXPECT_EQ(sample_.get("/legend/rings").status, 404);
  EXPECT_EQ(sample_.get("/legend").status, 404);
  EXPECT_EQ(sample_.get("/legend/rings@5x.png").status, 400);
  EXPECT_EQ(sample_.get("/legend/.json").status, 400);
  EXPECT_EQ(sample_.get("/legend/rings.png?fill=reddish").status, 400);
  EXPECT_EQ(sample_.get("/legend/%zz.json").status, 400);
}

TEST_F(LegendTest, APictureBeyondAllMeasureIsRefused) {
  std::string classes = "?color-by=name&classes=0:red";
  for (int i = 1; i < 64; ++i) classes += "," + std::to_string(i) + ":red";
  EXPECT_LT(picture("/legend/rings,west@3x.png" + classes).height, 8192);
  EXPECT_EQ(sample_.get("/legend/rings,west@4x.png" + classes).status, 400);
  EXPECT_EQ(sample_.get("/legend/rings,west.json" + classes).status, 200);
}

TEST_F(LegendTest, IsNotSentAgainToWhoHasIt) {
  const std::string tag(sample_.get("/legend/rings.png").header("ETag"));
  EXPECT_EQ(sample_.get("/legend/rings.png", tag).status, 304);
  EXPECT_EQ(sample_.get("/legend/rings.png?fill=blue", tag).status, 200);
}

}  // namespace
}  // namespace trapeze
