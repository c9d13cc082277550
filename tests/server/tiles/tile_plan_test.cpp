#include "server/tiles/tile_plan.h"

#include <gmock/gmock.h>

#include <set>
#include <string>
#include <vector>

#include "server/config/load_config.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

LayerStyle plain_style(Rgba fill) {
  LayerStyle style;
  style.paints = {{fill, {0, 0, 0, 255}}};
  return style;
}

auto fills(std::size_t layer, Rgba fill) {
  return ::testing::AllOf(
      ::testing::Field(&LayerPaint::layer, layer),
      ::testing::ResultOf([](const LayerPaint& p) { return p.style.paint_of_others().fill; },
                          fill));
}

class TilePlanTest : public ::testing::Test {
 protected:
  TilePlan plan(const std::string& target) const {
    const auto parsed = parse_tiles_target(split_target("/tiles/" + target).value(), StyleBook());
    auto planned = plan_tile(std::get<TileRequest>(*parsed), dataset_);
    return *planned;
  }
  std::string key(const std::string& target) const { return plan(target).key(); }
  /// The level of the default tolerance for tiles of 256 pixels.
  static Level usual_level(int zoom) {
    return nearest_level(static_cast<double>(TileId{zoom, 0, 0}.side()) / 256 / 4);
  }

  const std::shared_ptr<const Dataset> dataset_ = testing::sample_dataset();
};

TEST_F(TilePlanTest, TheDefaultToleranceIsTheOneThatParametersTell) {
  EXPECT_EQ(format_value(kTolerancePixels), style_parameter(ParameterId::simplify).default_text);
}

TEST_F(TilePlanTest, FillsInTheLayersOwnColours) {
  const TilePlan plan = this->plan("rings,west/0/0/0.png");
  EXPECT_THAT(plan.layers,
              ::testing::ElementsAre(fills(0, {255, 0, 0, 255}), fills(1, {0, 0, 255, 128})));
  EXPECT_EQ(plan.background, kTransparent);
}

TEST_F(TilePlanTest, TheRequestGoesBeforeTheConfiguration) {
  const TilePlan plan =
      this->plan("rings,west/0/0/0.png?fill=lime&west.fill-opacity=1&background=ffff0080");
  EXPECT_THAT(plan.layers,
              ::testing::ElementsAre(fills(0, {0, 255, 0, 255}), fills(1, {0, 255, 0, 255})));
  EXPECT_EQ(plan.background, (Rgba{255, 255, 0, 128}));
}

TEST_F(TilePlanTest, LeavesOutLayersThatCannotBeSeen) {
  EXPECT_EQ(plan("west/5/0/0.png").layers.size(), 1u);
  EXPECT_EQ(plan("west/6/0/0.png").layers.size(), 0u);
  EXPECT_EQ(plan("rings/0/0/0.png?fill-opacity=0").layers.size(), 0u);
}

TEST_F(TilePlanTest, OneThatNobodyKnowsIsNotFound) {
  const auto parsed =
      parse_tiles_target(split_target("/tiles/rings,nosuch/0/0/0.png").value(), StyleBook());
  const auto planned = plan_tile(std::get<TileRequest>(*parsed), dataset_);
  const auto& problem = planned.problem();
  EXPECT_EQ(problem.status, 404);
  EXPECT_EQ(problem.value, "nosuch");
}

TEST_F(TilePlanTest, EqualPicturesHaveEqualKeys) {
  const std::string same = key("rings/3/4/4.png");
  for (const char* target :
       {"rings/3/4/4@1x.png", "rings,rings/3/4/4.png", "rings/3/4/4.png?fill=red",
        "rings/3/4/4.png?rings.fill=F00&fill=blue", "rings/3/4/4.png?_=1",
        "rings/3/4/4.png?background=ff000000", "rings/3/4/4.png?fill-opacity=1.0"}) {
    EXPECT_EQ(key(target), same) << target;
  }
}

TEST_F(TilePlanTest, DifferentPicturesHaveDifferentKeys) {
  const std::string key = this->key("rings/3/4/4.png");
  for (const char* target :
       {"rings/3/4/4@2x.png", "rings/3/4/3.png", "rings/3/3/4.png", "rings/2/3/3.png",
        "west/3/4/4.png", "rings,west/3/4/4.png", "rings/3/4/4.png?fill=fe0000",
        "rings/3/4/4.png?background=white", "rings/3/4/4.png?fill-opacity=0.5"}) {
    EXPECT_NE(this->key(target), key) << target;
  }
  EXPECT_NE(this->key("rings,west/3/4/4.png"), this->key("west,rings/3/4/4.png"));
}

TEST_F(TilePlanTest, ToleranceIsPartOfTheKeyOfLabels) {
  const std::string query = "/3/4/4.png?label=name&simplify=";
  EXPECT_NE(key("rings" + query + "0.24"), key("rings" + query + "0.25")) << "at the same level";
  const std::string alone = "/3/4/4.png?fill-opacity=0&label=name&simplify=";
  EXPECT_NE(key("rings" + alone + "0"), key("rings" + alone + "8")) << "nothing but labels";
}

TEST_F(TilePlanTest, TheNumbersOfATileArePartOfTheKeyIfTheyAreDrawn) {
  TilePlan plan = this->plan("rings/3/4/4.png?debug=tile");
  const std::string key = plan.key();
  plan.caption.clear();  // as in a window of the same place
  EXPECT_NE(plan.key(), key);
}

TEST_F(TilePlanTest, TheKeyDependsOnTheDataAndNotOnTheRun) {
  const auto again = testing::sample_dataset();
  EXPECT_EQ(again->generation(), dataset_->generation());
  TilePlan plan = this->plan("rings/0/0/0.png");
  const std::string key = plan.key();
  plan.dataset = again;
  EXPECT_EQ(plan.key(), key);
  auto layers = layers_of_files({testing::fixture("west.geojson")});
  layers[0].name = "rings";  // the same name with other contents
  plan.dataset = Dataset::load(layers);
  EXPECT_NE(plan.key(), key);
}

/// A meadow and a lake, each a ring of coordinates.
std::string meadow_and_lake(const std::string& meadow, const std::string& lake) {
  const auto feature = [](const std::string& kind, const std::string& ring) {
    return R"({"type":"Feature","properties":{"kind":")" + kind +
           R"("},"geometry":{"type":"Polygon","coordinates":[[)" + ring + "]]}}";
  };
  return R"({"type":"FeatureCollection","features":[)" + feature("meadow", meadow) + "," +
         feature("lake", lake) + "]}";
}

TEST_F(TilePlanTest, FeaturesThatChangePlacesChangeTheKey) {
  const std::string west = "[0,0],[9,0],[9,9],[0,9],[0,0]";
  const std::string east = "[20,0],[29,0],[29,9],[20,9],[20,0]";
  const TemporaryFolder folder;
  const auto load = [&](const std::string& text) {
    return Dataset::load(layers_of_files({folder.write("land.geojson", text)}));
  };
  const auto before = load(meadow_and_lake(west, east));
  const auto after = load(meadow_and_lake(east, west));
  EXPECT_NE(after->layers()[0].revision, before->layers()[0].revision);
  EXPECT_NE(after->generation(), before->generation());
  EXPECT_EQ(load(meadow_and_lake(west, east))->generation(), before->generation());
}

TEST_F(TilePlanTest, ToleranceIsAQuarterOfAnOutputPixel) {
  const double pixel = static_cast<double>(TileId{10, 0, 0}.side()) / 256;
  EXPECT_EQ(plan("rings/10/0/0.png").layers[0].level, nearest_level(pixel / 4));
  EXPECT_EQ(plan("rings/10/0/0@2x.png").layers[0].level, nearest_level(pixel / 8));
}

TEST_F(TilePlanTest, ARequestedToleranceIsInOutputPixels) {
  const double pixel = static_cast<double>(TileId{10, 0, 0}.side()) / 256;
  EXPECT_EQ(plan("rings/10/0/0.png?simplify=0").layers[0].level, 0);
  EXPECT_EQ(plan("rings/10/0/0.png?simplify=3").layers[0].level, nearest_level(3 * pixel));
  EXPECT_EQ(plan("rings/10/0/0@2x.png?simplify=3").layers[0].level, nearest_level(1.5 * pixel));
}

TEST_F(TilePlanTest, DustIsTakenTogetherWithinPixelsWhateverTheTolerance) {
  for (const char* query : {"", "?simplify=0", "?simplify=64"}) {
    const TilePlan plan = this->plan(std::string("rings/10/0/0@2x.png") + query);
    EXPECT_EQ(plan.pixel_level(), this->plan("rings/10/0/0@2x.png").layers[0].level) << query;
  }
}

TEST_F(TilePlanTest, EveryLayerMayBeGeneralizedInItsOwnWay) {
  const TilePlan plan = this->plan(
      "rings,west/3/0/0.png?small=drop&west.small=keep&rings.topology=fast&"
      "west.simplify=0");
  EXPECT_THAT(plan.layers,
              ::testing::ElementsAre(LayerPaint{0, plain_style({255, 0, 0, 255}), usual_level(3),
                                                Topology::fast, SmallPolygons::drop},
                                     LayerPaint{1, plain_style({0, 0, 255, 128}), 0,
                                                Topology::strict, SmallPolygons::keep}));
}

TEST_F(TilePlanTest, TheSameGeneralizationHasTheSameTagHoweverWritten) {
  const std::string same = key("rings/3/4/4.png");
  for (const char* query : {"simplify=0.25", "simplify=0.2500001", "small=dust", "topology=strict",
                            "rings.small=dust&small=drop", "topology=strict&simplify=2.5e-1"}) {
    EXPECT_EQ(key(std::string("rings/3/4/4.png?") + query), same) << query;
  }
  EXPECT_EQ(key("rings/3/4/4.png?debug=tile,mesh"), key("rings/3/4/4.png?debug=mesh,tile,mesh"));
}

TEST_F(TilePlanTest, EveryGeneralizationAndEveryMarkHasItsOwnTag) {
  std::set<std::string> keys;
  const std::vector<std::string> queries = {"",
                                            "simplify=0",
                                            "simplify=1",
                                            "simplify=64",
                                            "small=drop",
                                            "small=keep",
                                            "debug=faces",
                                            "debug=junctions",
                                            "debug=faces,junctions",
                                            "debug=mesh",
                                            "debug=tile",
                                            "debug=vertices",
                                            "debug=mesh,tile",
                                            "debug=mesh,tile,vertices",
                                            "topology=fast",
                                            "topology=fast&small=drop"};
  for (const std::string& query : queries) keys.insert(key("rings/3/4/4.png?" + query));
  EXPECT_EQ(keys.size(), queries.size());
}

TEST_F(TilePlanTest, AnInvisibleLayerIsKeptForItsMarks) {
  EXPECT_EQ(plan("rings/0/0/0.png?fill-opacity=0").layers.size(), 0u);
  const TilePlan plan = this->plan("rings/0/0/0.png?fill-opacity=0&debug=vertices,tile");
  EXPECT_EQ(plan.layers.size(), 1u);
  EXPECT_EQ(plan.debug, (DebugMarks{.vertices = true, .tile = true}));
}

}  // namespace
}  // namespace trapeze
