// Overlapping features of one layer, pixel by pixel.
#include <gmock/gmock.h>

#include <random>

#include "core/layer/layer_builder.h"
#include "core/layer/untested_layer.h"
#include "render/picture/png.h"
#include "server/service/site.h"
#include "tests/core/shapes/ring_text.h"
#include "tests/server/service/sample_picture.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using testing::box;
using testing::cell;
using testing::expect_near;
using testing::kPixel;

Rings polygon(const std::vector<std::pair<double, double>>& pixels) {
  Rings rings;
  std::vector<Point> ring;
  for (const auto& [x, y] : pixels) ring.push_back({cell(x), cell(y)});
  rings.add(ring);
  return rings;
}

/// Kinds and rings of features. Pixels of the tile of zoom 0, by id:
///   2  wood, inside the field: columns 64.5 to 96.5, rows 64.5 to 96.5
///   3  lake, over the eastern border of the field: columns 112 to 160, rows 48 to 80
///   4  wood: columns 32 to 96.4, rows 160 to 224
///   5  field, a neighbour of 4: columns 96.4 to 160, rows 160 to 224
///   6  lake, over both: columns 80 to 112, rows 176 to 208
///   7  field: a triangle with a slanted western side
///   8  wood: the southern part of 7, with the same sides
std::vector<std::pair<std::string, Rings>> overlapping_plots() {
  std::vector<std::pair<std::string, Rings>> plots;
  const auto add = [&plots](const char* kind, const Rings& rings) {
    plots.emplace_back(kind, rings);
  };
  add("field", box(32.5, 32.5, 128, 128));
  add("wood", box(64.5, 64.5, 96.5, 96.5));
  add("lake", box(112, 48, 160, 80));
  add("wood", box(32, 160, 96.4, 224));
  add("field", box(96.4, 160, 160, 224));
  add("lake", box(80, 176, 112, 208));
  add("field", polygon({{200.3, 20}, {240, 220.6}, {180.3, 220.6}}));
  add("wood", polygon({{190.3, 120.3}, {220.150625, 120.3}, {240, 220.6}, {180.3, 220.6}}));
  return plots;
}

/// `count` stars of 12 points around the middle, which all of them cover.
std::vector<std::pair<std::string, Rings>> stars(int count) {
  std::mt19937 random(1);
  std::vector<std::pair<std::string, Rings>> stars;
  for (int i = 0; i < count; ++i) {
    stars.emplace_back("wood", Rings());
    stars.back().second.add(random_star(random, {0, 0}, 12, 30 * kPixel, 100 * kPixel));
  }
  return stars;
}

std::shared_ptr<const Dataset> layer_of(std::vector<std::pair<std::string, Rings>> plots) {
  FeatureTable features({{"kind", FieldType::text}});
  std::vector<LayerBuilder> builders(1);
  for (auto& [kind, rings] : plots) {
    const auto id = static_cast<std::int64_t>(features.size()) + 1;
    const std::vector<Value> values = {std::string_view(kind)};
    builders.front().add(features.append(id, values), rings);
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

constexpr Rgba kField{255, 0, 0, 255};
constexpr Rgba kWood{0, 255, 0, 255};
constexpr Rgba kLake{0, 0, 255, 255};
constexpr Rgba kYellow{255, 255, 0, 255};
const std::string kClasses = "color-by=kind&classes=field:red,wood:lime,lake:blue";
const std::string kHalfOpaque = "fill-opacity=0.5";

class OverlapPicturesTest : public ::testing::Test {
 protected:
  Picture tile(const std::string& query) {
    const std::string target = "/tiles/plots/0/0/0.png?quality=exact&" + query;
    return testing::picture_of(site_, target);
  }

  testing::SampleSite site_{false};

  void SetUp() override { site_.data().set(layer_of(overlapping_plots())); }
};

TEST_F(OverlapPicturesTest, AreTheSameWithoutTheTestOfTopology) {
  for (const std::string& style : {kClasses, kClasses + "&stroke=000", kHalfOpaque}) {
    const std::string target = "/tiles/plots/0/0/0.png?" + style;
    const HttpResponse apart = site_.get(target + "&topology=fast");
    ASSERT_EQ(apart.status, 200) << style;
    EXPECT_EQ(*apart.body, *site_.get(target).body) << style;
  }
}

TEST_F(OverlapPicturesTest, TheLaterFeatureIsOnTop) {
  const Picture picture = tile(kClasses);
  EXPECT_EQ(picture.at(50, 50), kField);
  EXPECT_EQ(picture.at(80, 80), kWood);
  EXPECT_EQ(picture.at(120, 60), kLake);
  EXPECT_EQ(picture.at(150, 60), kLake);
  // Along the border of the wood each kind covers its share of the pixel.
  expect_near(picture.at(64, 80), {128, 128, 0, 255}, 1);
  expect_near(picture.at(96, 96), {191, 64, 0, 255}, 1);
}

TEST_F(OverlapPicturesTest, NeighboursBelowAnotherFeatureLeaveNoLine) {
  const Picture picture = tile(kClasses);
  EXPECT_EQ(picture.at(96, 190), kLake);
  expect_near(picture.at(96, 170), {153, 102, 0, 255}, 1);
  for (int row = 160; row < 224; ++row) EXPECT_EQ(picture.at(96, row).a, 255) << row;
}

TEST_F(OverlapPicturesTest, WhereSidesCoincideNothingOfTheLowerOneIsSeen) {
  const Picture picture = tile(kClasses);
  for (int row = 122; row < 220; ++row) {
    for (int column = 178; column < 242; ++column) {
      EXPECT_EQ(picture.at(column, row).r, 0) << column << ' ' << row;
    }
  }
  EXPECT_EQ(picture.at(200, 80), kField);
}

TEST_F(OverlapPicturesTest, WithoutTheUpperOneTheLowerOneIsSeen) {
  EXPECT_EQ(tile(kClasses + "&filter=kind<>'wood'").at(80, 80), kField);
  EXPECT_EQ(tile(kClasses + "&ids=1,3").at(80, 80), kField);
  EXPECT_EQ(tile("color-by=kind&classes=field:red,wood:rgba(0,255,0,0),*:blue").at(80, 80), kField);
}

TEST_F(OverlapPicturesTest, AHighlightedFeatureIsTopmost) {
  const std::string highlight = "&highlight-fill=yellow&highlight=";
  const Picture picture = tile(kClasses + highlight + "1");
  for (const auto& [column, row] : {std::pair(50, 50), {80, 80}, {120, 60}}) {
    EXPECT_EQ(picture.at(column, row), kYellow);
  }
  EXPECT_EQ(picture.at(150, 60), kLake);
  EXPECT_EQ(tile("fill=red" + highlight + "2").at(80, 80), kYellow);
  EXPECT_EQ(tile("fill=red" + highlight + "1,3").at(120, 60), kYellow);
}

TEST_F(OverlapPicturesTest, HalfOpaqueFeaturesAreLaidOverEachOther) {
  // As in QGIS and Mapnik: two translucent features of one colour are more opaque than one.
  const Picture plain = tile("fill=red&fill-opacity=0.5");
  expect_near(plain.at(50, 50), {255, 0, 0, 128}, 1);
  expect_near(plain.at(80, 80), {255, 0, 0, 191}, 1);
  const Picture classes = tile(kClasses + "&fill-opacity=0.5");
  expect_near(classes.at(50, 50), {255, 0, 0, 128}, 1);
  expect_near(classes.at(80, 80), {85, 170, 0, 191}, 1);
  // The opacity of a layer applies to the finished layer.
  expect_near(tile(kClasses + "&opacity=0.5").at(80, 80), {0, 255, 0, 128}, 1);
}

TEST_F(OverlapPicturesTest, OutlinesAreHiddenByWhatLiesOverThem) {
  for (const std::string& style : {kClasses, std::string("fill=red")}) {
    const Picture picture = tile(style + "&stroke=black&stroke-width=2");
    const Picture fill = tile(style);
    const auto is_line = [&](int column, int row) {
      return picture.at(column, row) == Rgba{0, 0, 0, 255};
    };
    // The eastern side of the field: above the lake, below it, and where the lake covers it.
    EXPECT_TRUE(is_line(128, 40));
    EXPECT_TRUE(is_line(128, 90));
    EXPECT_EQ(picture.at(128, 60), fill.at(128, 60));
    // The border between two neighbours; the outline of the lake over it.
    EXPECT_TRUE(is_line(96, 168));
    EXPECT_EQ(picture.at(96, 190), fill.at(96, 190));
    EXPECT_TRUE(is_line(96, 176));
    // The same for a horizontal side.
    EXPECT_TRUE(is_line(112, 60));
  }
  const Picture seen = tile("fill=red&fill-opacity=0&stroke=black&stroke-width=2");
  EXPECT_EQ(seen.at(128, 60), (Rgba{0, 0, 0, 255})) << "nothing hides it";
}

TEST_F(OverlapPicturesTest, CostsMoreWhereTheOrderIsSeen) {
  const auto cost_at = [this](const std::string& tile, const std::string& query) {
    const HttpResponse response = site_.get("/tiles/plots/" + tile + ".png?" + query);
    EXPECT_EQ(response.status, 200) << query << (response.body ? *response.body : "");
    return std::stoi(std::string(response.header("X-Tile-Cost")));
  };
  const auto cost_of = [&cost_at](const std::string& query) { return cost_at("0/0/0", query); };
  // One colour hides the order, except along boundaries that share pixels: at zoom 0 all may, at
  // zoom 22 those that run along each other.
  EXPECT_EQ(cost_of("fill=red&fill-opacity=0.5"), cost_of("fill=red"));
  const std::string in_wood = "22/1310720/1310720";
  EXPECT_GT(cost_at(in_wood, "fill=red&fill-opacity=0.5"), cost_at(in_wood, "fill=red"));
  // The more translucent features overlap, the more parts there are.
  site_.data().set(layer_of(stars(40)));
  const int opaque = cost_of(kClasses);
  const int half = cost_of("fill=red&fill-opacity=0.5");
  EXPECT_GT(half, 10 * opaque);
  EXPECT_GT(cost_of("fill=red&fill-opacity=0.3"), 2 * half);
}

TEST_F(OverlapPicturesTest, ManyHalfOpaqueFeaturesAreDrawnAsFarAsTheyAreSeen) {
  site_.data().set(layer_of(stars(40)));
  const Picture picture = tile("fill=red&fill-opacity=0.5");
  expect_near(picture.at(128, 128), {255, 0, 0, 255}, 3);
  EXPECT_EQ(picture.at(2, 2).a, 0);
}

}  // namespace
}  // namespace trapeze
