// The effect of every style parameter on a picture, pixel by pixel where possible.
#include <gmock/gmock.h>

#include <cstdlib>
#include <random>

#include "core/layer/layer_builder.h"
#include "core/layer/untested_layer.h"
#include "render/picture/png.h"
#include "render/picture/webp.h"
#include "server/service/site.h"
#include "server/tiles/tile_painter.h"
#include "tests/server/service/sample_picture.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using testing::box;
using testing::cell;
using testing::expect_near;

/// Pixels of the tile of zoom 0, by id:
///   1  city, 500 people: columns 32 to 96.5, rows 32 to 96
///   2  village, 20 people: columns 96.5 to 160, rows 32 to 96
///   3  no kind, 100 people: columns 32 to 96, rows 128 to 192
///   4  a triangle, city, no people
///   10 to 25  specks, a sixteenth of a pixel each, in the pixel of column 200, row 40
std::shared_ptr<const Dataset> settlements() {
  FeatureTable features({{"kind", FieldType::text}, {"people", FieldType::integer}});
  std::vector<LayerBuilder> builders(1);
  const auto add = [&](std::int64_t id, Rings rings, std::vector<Value> values) {
    builders.front().add(features.append(id, values), rings);
  };
  add(1, box(32, 32, 96.5, 96), {"city", std::int64_t{500}});
  add(2, box(96.5, 32, 160, 96), {"village", std::int64_t{20}});
  add(3, box(32, 128, 96, 192), {Value(), std::int64_t{100}});
  Rings triangle;
  triangle.add(
      std::vector<Point>{{cell(120), cell(200)}, {cell(220), cell(200)}, {cell(170), cell(130)}});
  add(4, triangle, {"city", Value()});
  for (int i = 0; i < 16; ++i) {
    const double x = 200 + 0.25 * (i % 4) + 0.01;
    const double y = 40 + 0.25 * (i / 4) + 0.01;
    add(10 + i, box(x, y, x + 0.23, y + 0.23), {"speck", std::int64_t{1}});
  }
  ServedLayer served;
  served.config.name = "plots";
  served.config.title = "Plots";
  served.config.style = testing::style_of("fill=808080");
  served.layer = LayerBuilder::join(builders, std::move(features));
  served.untested = build_without_topology_test(*served.layer);
  served.revision = revision_of(*served.layer);
  std::vector<ServedLayer> layers;
  layers.push_back(std::move(served));
  return std::make_shared<const Dataset>(std::move(layers));
}

class StylePicturesTest : public ::testing::Test {
 protected:
  Picture tile(const std::string& query, const std::string& name = "0/0/0.png") {
    const std::string target = "/tiles/plots/" + name + "?" + query;
    return testing::picture_of(site_, target);
  }
  Rgba at(const std::string& query, int column, int row) { return tile(query).at(column, row); }

  testing::SampleSite site_{false};

  void SetUp() override { site_.data().set(settlements()); }
};

constexpr Rgba kRed{255, 0, 0, 255};
constexpr Rgba kBlue{0, 0, 255, 255};
constexpr Rgba kGrey{128, 128, 128, 255};

TEST_F(StylePicturesTest, ClassesByValue) {
  const Picture picture = tile("color-by=kind&classes=city:red,village:blue,null:lime");
  EXPECT_EQ(picture.at(60, 60), kRed);
  EXPECT_EQ(picture.at(130, 60), kBlue);
  EXPECT_EQ(picture.at(60, 160), (Rgba{0, 255, 0, 255}));
  EXPECT_EQ(picture.at(170, 180), kRed);
  EXPECT_EQ(picture.at(10, 10), kTransparent);
  const Picture rest = tile("color-by=kind&classes=village:blue,*:red");
  EXPECT_EQ(rest.at(60, 60), kRed);
  EXPECT_EQ(rest.at(60, 160), kRed);
  EXPECT_EQ(tile("color-by=kind&classes=village:blue").at(60, 60), kGrey);
}

TEST_F(StylePicturesTest, NeighboursOfDifferentClassesMixWithoutAGap) {
  const Picture picture = tile("color-by=kind&classes=city:red,village:blue");
  for (int row = 32; row < 96; ++row) {
    expect_near(picture.at(96, row), {128, 0, 128, 255}, 1);
    EXPECT_EQ(picture.at(96, row).a, 255);
  }
  const Picture pale = tile("color-by=kind&classes=city:red,village:blue&fill-opacity=0.5");
  expect_near(pale.at(96, 50), {128, 0, 128, 128}, 1);
  expect_near(pale.at(60, 50), {255, 0, 0, 128}, 1);
}

TEST_F(StylePicturesTest, ClassesBetweenBreaks) {
  const Picture picture = tile("color-by=people&breaks=100,300&ramp=Reds");
  const Rgba low = picture.at(130, 60);
  const Rgba middle = picture.at(60, 160);
  const Rgba high = picture.at(60, 60);
  EXPECT_GT(low.g, middle.g);
  EXPECT_GT(middle.g, high.g);
  EXPECT_EQ(picture.at(170, 180), kGrey);  // no number
  EXPECT_EQ(tile("color-by=people&breaks=100,300&ramp=Reds-r").at(130, 60), high);
}

TEST_F(StylePicturesTest, FilterAndIdsLeaveTheOthersOut) {
  const Picture cities = tile("filter=kind='city'");
  EXPECT_EQ(cities.at(60, 60), kGrey);
  EXPECT_EQ(cities.at(170, 180), kGrey);
  EXPECT_EQ(cities.at(130, 60), kTransparent);
  EXPECT_EQ(cities.at(60, 160), kTransparent);
  EXPECT_EQ(cities.at(200, 40), kTransparent);  // dust is filtered out, too
  const Picture some = tile("ids=2,3");
  EXPECT_EQ(some.at(60, 60), kTransparent);
  EXPECT_EQ(some.at(130, 60), kGrey);
  EXPECT_EQ(some.at(60, 160), kGrey);
  const Picture none = tile("filter=people>10000");
  EXPECT_EQ(none.at(60, 60), kTransparent);
}

TEST_F(StylePicturesTest, HighlightedFeaturesStandOut) {
  const Picture picture = tile("highlight=2&highlight-fill=red&highlight-stroke=blue&stroke=lime");
  EXPECT_EQ(picture.at(60, 60), kGrey);
  EXPECT_EQ(picture.at(130, 60), kRed);
  expect_near(picture.at(130, 32), {64, 0, 191, 255}, 70);  // half of the line is inside
  EXPECT_GT(picture.at(60, 32).g, 150);                     // the outline of the others
}

TEST_F(StylePicturesTest, OutlinesFollowAllEdgesTheLevelOnesToo) {
  const Picture picture = tile("fill=none&stroke=red&stroke-width=2");
  for (int i = 33; i < 95; ++i) {
    EXPECT_EQ(picture.at(i, 32), kRed) << i;  // the line covers rows 31 to 33
    EXPECT_EQ(picture.at(i, 31), kRed) << i;
    EXPECT_EQ(picture.at(i, 95), kRed) << i;
    EXPECT_EQ(picture.at(32, i), kRed) << i;
    EXPECT_EQ(picture.at(i, 30), kTransparent) << i;
    EXPECT_EQ(picture.at(i, 34), kTransparent) << i;
  }
  EXPECT_EQ(picture.at(60, 60), kTransparent);
  EXPECT_EQ(picture.at(200, 40), kTransparent);  // dust has no outline
}

TEST_F(StylePicturesTest, OutlinesOverlapWithoutGettingDarker) {
  const Picture picture = tile("fill=none&stroke=red&stroke-width=6&stroke-opacity=0.5");
  for (int row = 0; row < 256; ++row) {
    for (int column = 0; column < 256; ++column) {
      ASSERT_LE(picture.at(column, row).a, 128) << column << " " << row;
    }
  }
  // The outline of both neighbours, drawn once.
  EXPECT_EQ(picture.at(96, 60).a, 128);
}

TEST_F(StylePicturesTest, DashesAndJoins) {
  const auto count = [this](const std::string& query) {
    const Picture picture = tile("ids=4&fill=none&stroke=red&stroke-width=8&" + query);
    double sum = 0;
    for (int i = 0; i < 256 * 256; ++i) sum += picture.at(i % 256, i / 256).a / 255.0;
    return sum;
  };
  const double round = count("stroke-linejoin=round");
  EXPECT_GT(count("stroke-linejoin=miter"), round + 10);
  EXPECT_LT(count("stroke-linejoin=bevel"), round - 3);
  EXPECT_NEAR(count("stroke-dasharray=5,5") / round, 0.5, 0.03);
  EXPECT_NEAR(count("stroke-dasharray=3") / round, 0.5, 0.03);
  EXPECT_NEAR(count("stroke-dasharray=9,1") / round, 0.9, 0.03);
}

TEST_F(StylePicturesTest, PatternsLieWithinThePolygons) {
  for (const std::string kind : {"checker", "crosshatch", "dots", "hatch", "stripes"}) {
    const Picture picture = tile("fill=none&pattern-color=blue&pattern=" + kind);
    int covered = 0;
    for (int row = 40; row < 90; ++row) {
      for (int column = 40; column < 90; ++column) covered += picture.at(column, row).a > 128;
    }
    EXPECT_GT(covered, 100) << kind;
    EXPECT_LT(covered, 2000) << kind;
    EXPECT_EQ(picture.at(10, 10), kTransparent);
    EXPECT_EQ(picture.at(110, 110), kTransparent);
  }
  const Picture over = tile("pattern=stripes&pattern-color=blue&pattern-angle=90&pattern-size=16");
  int blue = 0;
  for (int column = 32; column < 96; ++column) blue += over.at(column, 60) == kBlue;
  EXPECT_NEAR(blue, 32, 8);
}

TEST_F(StylePicturesTest, OpacityIsOfTheLayerAsAWhole) {
  const Picture picture = tile("stroke=red&stroke-width=4&opacity=0.5");
  EXPECT_EQ(picture.at(33, 60), (Rgba{255, 0, 0, 128}));
  EXPECT_EQ(picture.at(60, 60), (Rgba{128, 128, 128, 128}));
  const Picture nothing = tile("opacity=0");
  EXPECT_EQ(nothing.at(60, 60), kTransparent);
}

TEST_F(StylePicturesTest, DustHasTheColourOfItsClass) {
  const double area = 16 * 0.23 * 0.23;  // of the pixel
  const int level = static_cast<int>(area * 255);
  expect_near(at("quality=exact", 200, 40), {128, 128, 128, static_cast<std::uint8_t>(level)}, 4);
  expect_near(at("quality=exact&color-by=kind&classes=speck:red", 200, 40),
              {255, 0, 0, static_cast<std::uint8_t>(level)}, 4);
  expect_near(at("quality=exact&ids=10,11,12,13,14,15,16,17", 200, 40),
              {128, 128, 128, static_cast<std::uint8_t>(level / 2)}, 4);
  EXPECT_EQ(at("small=drop&color-by=kind&classes=speck:red", 200, 40), kTransparent);
  EXPECT_EQ(at("small=keep&color-by=kind&classes=speck:red", 200, 40), kRed);
}

TEST_F(StylePicturesTest, AStyleOfOneClassDrawsWhatThePlainOneDraws) {
  const Picture plain = tile("fill=red");
  const Picture classed = tile("color-by=kind&classes=*:red");
  for (int row = 0; row < 256; ++row) {
    for (int column = 0; column < 256; ++column) {
      const Rgba a = plain.at(column, row);
      const Rgba b = classed.at(column, row);
      ASSERT_NEAR(a.a, b.a, 2) << column << " " << row;
    }
  }
}

/// Styles with lengths in pixels of a picture of scale 1, multiplied by a factor.
std::vector<std::string> styles_of_size(double factor) {
  const auto px = [factor](double length) { return std::to_string(length * factor); };
  return {
      "stroke=red&stroke-linejoin=miter&stroke-width=" + px(5),
      "stroke=blue&stroke-width=" + px(2) + "&stroke-dasharray=" + px(7) + "," + px(3) + "," +
          px(1) + "," + px(3),
      "pattern=hatch&pattern-angle=33&pattern-size=" + px(11) + "&pattern-width=" + px(2),
      "pattern=dots&fill=none&pattern-size=" + px(9) + "&pattern-width=" + px(4),
      "color-by=kind&classes=city:red,village:blue,speck:lime&stroke=black&stroke-width=" + px(1.5),
      "highlight=2,4&opacity=0.7&stroke=navy&pattern=checker&stroke-width=" + px(3) +
          "&pattern-size=" + px(12)};
}

TEST_F(StylePicturesTest, NeighbouringTilesJoinInEveryStyle) {
  // Four tiles of one zoom show the same as one tile of the previous zoom at twice the scale.
  const std::vector<std::string> of_quarters = styles_of_size(1);
  const std::vector<std::string> of_whole = styles_of_size(0.5);
  for (std::size_t i = 0; i < of_whole.size(); ++i) {
    const Picture whole = tile(of_whole[i], "0/0/0@2x.png");
    for (int quarter = 0; quarter < 4; ++quarter) {
      const int east = quarter % 2;
      const int south = quarter / 2;
      const Picture part =
          tile(of_quarters[i], "1/" + std::to_string(east) + "/" + std::to_string(south) + ".png");
      for (int row = 0; row < 256; ++row) {
        for (int column = 0; column < 256; ++column) {
          const Rgba a = part.at(column, row);
          const Rgba b = whole.at(column + 256 * east, row + 256 * south);
          ASSERT_NEAR(a.a, b.a, 2) << of_quarters[i] << " at " << column << " " << row;
          if (a.a < 64) continue;
          ASSERT_NEAR(a.r, b.r, 3) << of_quarters[i] << " at " << column << " " << row;
          ASSERT_NEAR(a.b, b.b, 3) << of_quarters[i] << " at " << column << " " << row;
        }
      }
    }
  }
}

/// Random parameters with valid and invalid values.
std::string random_query(std::mt19937& random) {
  static const std::vector<std::string> values = {"red",
                                                  "none",
                                                  "%23abc",
                                                  "rgba(1,2,3,0.5)",
                                                  "0",
                                                  "0.5",
                                                  "1",
                                                  "64",
                                                  "-1",
                                                  "1e9",
                                                  "nan",
                                                  "3,2",
                                                  "5",
                                                  "kind",
                                                  "people",
                                                  "nosuch",
                                                  "city:red",
                                                  "city:red,*:blue",
                                                  "'a,b':lime",
                                                  "10,100",
                                                  "100,10",
                                                  "Reds",
                                                  "Blues-r",
                                                  "hatch",
                                                  "dots",
                                                  "checker",
                                                  "strict",
                                                  "fast",
                                                  "keep",
                                                  "drop",
                                                  "mesh",
                                                  "mesh,vertices",
                                                  "miter",
                                                  "bevel",
                                                  "round",
                                                  "1,2,3",
                                                  "kind='city'",
                                                  "people%20BETWEEN%201%20AND%20100",
                                                  "NOT(kind%20IS%20NULL)",
                                                  "kind%20LIKE%20'c%25'",
                                                  "people%20IN%20(1,2,",
                                                  "%00",
                                                  "%ff%fe",
                                                  "''''",
                                                  "default",
                                                  ""};
  const auto pick = [&random](std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
  };
  std::string query;
  for (std::size_t k = 1 + pick(6); k > 0; --k) {
    const auto parameters = style_parameters();
    if (!query.empty()) query += '&';
    if (pick(8) == 0) query += pick(20) == 0 ? "x." : "plots.";
    query += parameters[pick(parameters.size())].name;
    query += "=" + values[pick(values.size())];
    if (pick(50) == 0) query[pick(query.size())] = static_cast<char>(pick(256));
  }
  return query;
}

TEST_F(StylePicturesTest, NoQueryEverFails) {
  const auto dataset = settlements();
  const StyleBook styles;
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  int planned = 0;
  for (int i = 0; i < 100'000; ++i) {
    const std::string query = random_query(random);
    const auto parsed =
        parse_tiles_target(split_target("/tiles/plots/1/0/0.png?" + query).value(), styles);
    if (!parsed) {
      ASSERT_EQ(parsed.problem().status, 400) << query;
      continue;
    }
    const auto plan = plan_tile(std::get<TileRequest>(*parsed), dataset);
    if (!plan) {
      // A missing table is 404, every other mistake is 400.
      const int wrong = plan.problem().parameter == "values" ? 404 : 400;
      ASSERT_EQ(plan.problem().status, wrong) << query;
      continue;
    }
    if (++planned % 40 != 0) continue;
    const HttpResponse response = site_.get("/tiles/plots/1/0/0.png?" + query);
    ASSERT_EQ(response.status, 200) << query;
    ASSERT_NO_THROW(decode_png(*response.body)) << query;
  }
  EXPECT_GT(planned, 1'000);
}

TEST_F(StylePicturesTest, TilesComeAsWebpToo) {
  if (!has_webp()) GTEST_SKIP() << "built without libwebp";
  for (const std::string name : {"0/0/0.webp", "0/0/0@2x.webp", "5/0/0.webp"}) {
    const HttpResponse webp = site_.get("/tiles/plots/" + name);
    ASSERT_EQ(webp.status, 200) << name;
    EXPECT_EQ(webp.header("Content-Type"), "image/webp");
    EXPECT_EQ(webp.body->substr(0, 4), "RIFF");
    EXPECT_EQ(webp.body->substr(8, 4), "WEBP");
    const HttpResponse png = site_.get("/tiles/plots/" + name.substr(0, name.size() - 4) + "png");
    EXPECT_EQ(png.header("Content-Type"), "image/png");
    EXPECT_NE(webp.header("ETag"), png.header("ETag"));
  }
  EXPECT_EQ(site_.get("/legend/plots.webp").status, 404);
  EXPECT_EQ(site_.get("/tiles/plots/0/0/0.jpg").status, 400);
}

TEST_F(StylePicturesTest, ScaleDoublesLengths) {
  const Picture one = tile("fill=none&stroke=red&stroke-width=2");
  const Picture two = tile("fill=none&stroke=red&stroke-width=2", "0/0/0@2x.png");
  ASSERT_EQ(two.width, 512);
  for (int i = 70; i < 180; ++i) {
    EXPECT_EQ(two.at(i, 63), kRed);
    EXPECT_EQ(two.at(i, 65), kRed);
    EXPECT_EQ(two.at(i, 67), kTransparent);
  }
}

}  // namespace
}  // namespace trapeze
