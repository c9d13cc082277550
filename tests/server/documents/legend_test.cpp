#include "server/documents/legend.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "render/picture/png.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

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

  testing::SampleSite sample_;
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

TEST_F(LegendTest, ThePictureShowsTheColoursOnWhite) {
  const Picture picture = this->picture("/legend/rings,west.png");
  EXPECT_EQ(picture.at(0, 0), (Rgba{255, 255, 255, 255}));
  EXPECT_EQ(picture.at(16, 14), (Rgba{127, 127, 255, 255})) << "half opaque blue on white";
  EXPECT_EQ(picture.at(16, 30), (Rgba{255, 0, 0, 255}));
  const Picture twice = this->picture("/legend/rings,west@2x.png");
  EXPECT_EQ(twice.width, 2 * picture.width);
  EXPECT_EQ(twice.height, 2 * picture.height);
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
