// Pictures in which narrow features have grown, requested over HTTP.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "core/layer/layer_builder.h"
#include "server/service/site.h"
#include "tests/core/shapes/layers.h"
#include "tests/server/service/sample_picture.h"
#include "tests/server/service/sample_site.h"
#include "tests/server/tiles/same_by_gl.h"

namespace trapeze {
namespace {

using testing::Place;
using testing::point_at;
using testing::Ring;

Ring rectangle(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

Ring turned(const Ring& ring, Place around, double angle) {
  Ring result;
  for (const Place p : ring) {
    const double x = p.x - around.x;
    const double y = p.y - around.y;
    result.push_back({around.x + x * std::cos(angle) - y * std::sin(angle),
                      around.y + x * std::sin(angle) + y * std::cos(angle)});
  }
  return result;
}

Rings rings_of(const Ring& ring) {
  std::vector<Point> points;
  for (const Place p : ring) points.push_back(point_at(p.x, p.y));
  Rings rings;
  rings.add(points);
  return rings;
}

ServedLayer served(const std::string& name, std::unique_ptr<Layer> layer) {
  ServedLayer result;
  result.config.name = name;
  result.config.title = name;
  result.config.style = testing::style_of("fill=808080&fill-opacity=1");
  result.layer = std::move(layer);
  result.revision = revision_of(*result.layer);
  return result;
}

/// Houses and narrow strips, in all directions.
std::vector<Rings> village() {
  std::mt19937 random(7);
  std::vector<Rings> houses;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      const Place middle{20 + x * 11.0, 20 + y * 11.0};
      const double width = 1 + static_cast<double>(random() % 90) / 10;
      const double height = 0.5 + static_cast<double>(random() % 40) / 20;
      const Ring house = rectangle(middle.x - width / 2, middle.y - height / 2, width, height);
      houses.push_back(rings_of(turned(house, middle, static_cast<double>(random() % 314) / 100)));
    }
  }
  return houses;
}

class GrowPicturesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::vector<ServedLayer> layers;
    layers.push_back(served("village", layer_of(village())));
    const Place middle{128, 128};
    const Ring strip = rectangle(68, 127.5, 120, 1);
    layers.push_back(served("strip", layer_of({rings_of(turned(strip, middle, 0.4))})));
    layers.push_back(
        served("wide", layer_of({rings_of(rectangle(40.3, 40, 90, 90.7)),
                                 rings_of(turned(rectangle(160, 160, 30, 20), middle, 0.2))})));
    layers.push_back(served("islet", layer_of({rings_of(rectangle(100, 100, 0.05, 0.05))})));
    layers.push_back(served("post", layer_of({rings_of(rectangle(134, 20, 0.4, 100))})));
    layers.push_back(served("land", land()));
    dataset_ = std::make_shared<const Dataset>(std::move(layers));
    site_.data().set(dataset_);
  }

  /// Fields on both sides of a winding river, as a coverage.
  static std::unique_ptr<Layer> land() {
    const Ring north_bank{{20, 120}, {90, 130}, {150, 100}, {230, 124}};
    Ring south_bank = north_bank;
    for (Place& p : south_bank) p.y += 1.2;
    const auto ring = [](Ring one, const Ring& other) {
      one.insert(one.end(), other.rbegin(), other.rend());
      return rings_of(one);
    };
    const std::vector<Rings> rings{
        ring({{20, 20}, {230, 20}}, {{20, 120}, {90, 130}, {150, 100}, {230, 124}}),
        ring(north_bank, south_bank), ring(south_bank, {{20, 240}, {230, 240}})};
    LayerOptions options;
    options.coverage = CoverageMode::automatic;
    std::vector<LayerBuilder> builders;
    builders.emplace_back(options);
    FeatureTable table(std::vector<Field>{{"kind", FieldType::text}});
    std::vector<std::uint32_t> rows;
    std::vector<const Rings*> all;
    constexpr std::array<std::string_view, 3> kKinds{"field", "river", "field"};
    for (std::size_t i = 0; i < rings.size(); ++i) {
      const std::array<Value, 1> values = {kKinds[i]};
      rows.push_back(table.append(static_cast<std::int64_t>(i), values));
      all.push_back(&rings[i]);
    }
    EXPECT_TRUE(builders.front().add_coverage(rows, all).apart.empty());
    return LayerBuilder::join(builders, std::move(table));
  }

  Picture tile(const std::string& layer_and_tile, const std::string& query) {
    return testing::picture_of(
        site_, "/tiles/" + layer_and_tile + ".png?quality=exact&simplify=0&" + query);
  }

  std::string etag(const std::string& layer_and_tile, const std::string& query) {
    return std::string(site_.get("/tiles/" + layer_and_tile + ".png?" + query).header("ETag"));
  }

  /// In pixels.
  static double area(const Picture& picture) {
    double sum = 0;
    for (const Rgba pixel : picture.pixels) sum += pixel.a;
    return sum / 255;
  }

  std::shared_ptr<const Dataset> dataset_;
  testing::SampleSite site_{false};
};

TEST_F(GrowPicturesTest, AStripIsAsWideAsAsked) {
  EXPECT_NEAR(area(tile("strip/0/0/0", "")), 120, 0.5);
  EXPECT_NEAR(area(tile("strip/0/0/0", "grow=1")), 120, 0.5);
  EXPECT_NEAR(area(tile("strip/0/0/0", "grow=2.5")), 300, 1);
  EXPECT_NEAR(area(tile("strip/0/0/0", "grow=16")), 16 * 120, 5);
  EXPECT_NEAR(area(tile("strip/0/0/0@2x", "grow=16")), 4 * 16 * 120, 20);
}

TEST_F(GrowPicturesTest, WhatIsWideIsDrawnAsItWas) {
  for (const char* more : {"", "&stroke=black&stroke-width=2"}) {
    EXPECT_TRUE(tile("wide/0/0/0", std::string("grow=16") + more).pixels ==
                tile("wide/0/0/0", more).pixels);
  }
}

TEST_F(GrowPicturesTest, AreasGrowWithTheNumber) {
  double last = area(tile("village/0/0/0", ""));
  for (const char* width : {"1", "1.5", "2", "3", "5", "8", "12", "16"}) {
    const double more = area(tile("village/0/0/0", std::string("grow=") + width));
    EXPECT_GE(more, last * 0.995) << width;
    last = more;
  }
  EXPECT_GT(last, 3 * area(tile("village/0/0/0", "")));
}

TEST_F(GrowPicturesTest, TilesFitTogether) {
  struct Drawn {
    std::string layer;
    std::string style;
    std::string at_next_zoom;
  };
  const std::string classes = "&color-by=kind&classes=field:fc0,river:00f";
  for (const auto& [name, style, at_next_zoom] :
       {Drawn{"village", "&stroke=black&stroke-width=1", "&stroke=black&stroke-width=2"},
        Drawn{"village", "&stroke=black&stroke-width=9", "&stroke=black&stroke-width=18"},
        Drawn{"land", classes, classes}}) {
    SCOPED_TRACE(name + style);
    const Picture whole = tile(name + "/1/0/0@2x", "grow=3" + style);
    for (int y = 0; y < 2; ++y) {
      for (int x = 0; x < 2; ++x) {
        const std::string at = "/2/" + std::to_string(x) + "/" + std::to_string(y);
        const Picture part = tile(name + at, "grow=6" + at_next_zoom);
        for (int row = 0; row < 256; ++row) {
          for (int column = 0; column < 256; ++column) {
            const Rgba one = part.at(column, row);
            const Rgba other = whole.at(256 * x + column, 256 * y + row);
            ASSERT_NEAR(one.a, other.a, 2) << at << ' ' << column << ' ' << row;
            ASSERT_NEAR(one.b, other.b, 2) << at << ' ' << column << ' ' << row;
          }
        }
      }
    }
  }
}

// What is wider than the world covers all of it.
TEST_F(GrowPicturesTest, APictureOfAFewPixelsIsCoveredByWhatIsWider) {
  for (const std::string window : {"crs=EPSG:3857&bbox=-20037508,-20037508,20037508,20037508",
                                   "crs=EPSG:4326&bbox=-180,-85,180,85"}) {
    for (const std::string size : {"1", "2", "3"}) {
      for (const std::string width : {"10", "12", "16"}) {
        const std::string query = window + "&width=" + size + "&height=" + size + "&grow=" + width;
        const Picture picture = testing::picture_of(site_, "/map/islet.png?quality=exact&" + query);
        for (const Rgba pixel : picture.pixels) EXPECT_EQ(pixel.a, 255) << query;
      }
    }
  }
}

TEST_F(GrowPicturesTest, ARiverTakesFromItsFieldsWhatItGets) {
  const std::string classes = "&color-by=kind&classes=field:fc0,river:00f";
  const Picture before = tile("land/0/0/0", "grow=0" + classes);
  const Picture after = tile("land/0/0/0", "grow=4" + classes);
  EXPECT_NEAR(area(after), area(before), 2) << "but for its ends, which are not quite square";
  const auto blue = [](const Picture& picture) {
    double sum = 0;
    for (const Rgba pixel : picture.pixels) sum += pixel.b;
    return sum / 255;
  };
  // 1.2 pixels from south to north; the slopes of its banks make it a little narrower.
  EXPECT_NEAR(blue(after) / blue(before), 4 / 1.16, 0.15);
  for (int column = 30; column < 220; ++column) {
    int whole = 0;
    for (int row = 90; row < 140; ++row) {
      const Rgba pixel = after.at(column, row);
      EXPECT_EQ(pixel.a, 255) << column << ' ' << row;
      whole += pixel.b == 255 ? 1 : 0;
    }
    EXPECT_GE(whole, 2) << "no field shines through the river, " << column;
  }
}

TEST_F(GrowPicturesTest, WhatIsFilteredKeepsItsPlaceAndIsNotDrawn) {
  const Picture picture = tile("land/0/0/0", "grow=6&filter=kind='field'");
  const Picture before = tile("land/0/0/0", "filter=kind='field'");
  EXPECT_TRUE(picture.pixels == before.pixels);
}

TEST_F(GrowPicturesTest, WhatIsTooSmallForTheToleranceIsASquare) {
  const auto of = [this](const std::string& query) {
    return area(testing::picture_of(site_, "/tiles/islet/0/0/0.png?quality=exact&" + query));
  };
  EXPECT_NEAR(of("grow=3"), 9, 0.2);
  EXPECT_NEAR(of("grow=3&small=dust"), 0, 0.1);
  EXPECT_EQ(of("grow=3&small=drop"), 0);
}

TEST_F(GrowPicturesTest, AnOutlineFollowsTheMovedBoundary) {
  const Picture picture = tile("strip/0/0/0", "grow=12&fill-opacity=0&stroke=000&stroke-width=2");
  EXPECT_NEAR(area(picture), 2 * 2 * (120 + 12), 6);
  EXPECT_EQ(picture.at(128, 128).a, 0) << "the boundary as it was is drawn";
}

TEST_F(GrowPicturesTest, AnOutlineReachesInFromTheNextTileAsFarAsItHasMoved) {
  // The post is 12 pixels outside the tile, and 9.4 pixels after it has grown; the outline is
  // faint.
  const std::string query = "fill-opacity=0&stroke=000&stroke-width=32";
  EXPECT_EQ(tile("post/1/0/0", query).at(250, 160).a, 0);
  EXPECT_GT(tile("post/1/0/0", query + "&grow=6").at(250, 160).a, 20);
}

TEST_F(GrowPicturesTest, TheTagOfATileTellsWhatHasGrownInIt) {
  EXPECT_NE(etag("strip/0/0/0", "grow=4"), etag("strip/0/0/0", ""));
  EXPECT_EQ(etag("strip/0/0/0", "grow=0"), etag("strip/0/0/0", ""));
  EXPECT_EQ(etag("wide/0/0/0", "grow=4"), etag("wide/0/0/0", ""));
}

TEST_F(GrowPicturesTest, MapsInDegreesHaveIt) {
  const auto of = [this](const std::string& query) {
    return area(testing::picture_of(
        site_,
        "/map/strip.png?crs=EPSG:4326&bbox=-90,-45,90,45&width=512&height=256&quality=exact" +
            query));
  };
  // The strip is 4 pixels wide here, or a little less.
  EXPECT_NEAR(of("&grow=8") / of(""), 2, 0.1);
}

TEST_F(GrowPicturesTest, AreTheSameByGl) {
  for (const char* target : {"village/0/0/0.png?quality=exact&grow=5&simplify=0",
                             "land/1/0/0.png?quality=exact&grow=9&simplify=0"}) {
    testing::expect_same_by_gl(target, dataset_);
  }
}

TEST_F(GrowPicturesTest, WrongNumbersAreProblems) {
  for (const char* value : {"-1", "17", "on", ""}) {
    const HttpResponse response = site_.get(std::string("/tiles/strip/0/0/0.png?grow=") + value);
    EXPECT_EQ(response.status, 400) << value;
    EXPECT_THAT(*response.body, ::testing::HasSubstr("a number from 0 to 16")) << value;
  }
  EXPECT_EQ(site_.get("/tiles/strip/0/0/0.png?grow=2&smooth=3").status, 400);
  EXPECT_EQ(site_.get("/tiles/strip/0/0/0.png?grow=2&smooth=0").status, 200);
}

}  // namespace
}  // namespace trapeze
