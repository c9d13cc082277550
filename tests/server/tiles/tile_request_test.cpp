#include "server/tiles/tile_request.h"

#include <gmock/gmock.h>

#include <string>

#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;

TileRequest tile_of(const std::string& target) {
  auto parsed = parse_tiles_target(split_target(target).value(), StyleBook());
  if (!parsed) {
    ADD_FAILURE() << target << ": " << parsed.problem().detail;
    return {};
  }
  return std::get<TileRequest>(*parsed);
}

int status_of(const std::string& target) {
  const auto parsed = parse_tiles_target(split_target(target).value(), StyleBook());
  return parsed ? 200 : parsed.problem().status;
}

TEST(TileRequestTest, ReadsLayersTileAndScale) {
  const TileRequest request = tile_of("/tiles/lakes,my-roads_2/7/64/127@3x.png");
  EXPECT_THAT(request.layers, ElementsAre("lakes", "my-roads_2"));
  EXPECT_EQ(request.tile, (TileId{7, 64, 127}));
  EXPECT_EQ(request.scale, 3);
  EXPECT_EQ(tile_of("/tiles/a/0/0/0.png").scale, 1);
}

TEST(TileRequestTest, NamesEachLayerOnceInTheOrderOfFirstMention) {
  EXPECT_THAT(tile_of("/tiles/b,a,b,a,c/0/0/0.png").layers, ElementsAre("b", "a", "c"));
  EXPECT_THAT(tile_of("/tiles/b%2Ca/0/0/0.png").layers, ElementsAre("b", "a"));
}

TEST(TileRequestTest, ReadsTheDescriptionOfTiles) {
  const auto parsed =
      parse_tiles_target(split_target("/tiles/a,b.json?b.fill=red").value(), StyleBook());
  const auto& request = std::get<TileJsonRequest>(*parsed);
  EXPECT_THAT(request.layers, ElementsAre("a", "b"));
  EXPECT_EQ(request.style.query(), "b.fill=ff0000ff");
  EXPECT_EQ(request.scale, 1);
}

TEST(TileRequestTest, DescriptionsHaveTheirScaleAndKeepTheNameOfTheStyle) {
  const StyleBook book({{"night", testing::style_of("fill=navy&stroke=white")}});
  for (const char* target :
       {"/tiles/a,b@2x.json?style=night&b.fill=red", "/tiles/a,b/s/night@2x.json?b.fill=red"}) {
    const auto parsed = parse_tiles_target(split_target(target).value(), book);
    ASSERT_TRUE(parsed) << target;
    const auto& request = std::get<TileJsonRequest>(*parsed);
    EXPECT_THAT(request.layers, ElementsAre("a", "b"));
    EXPECT_EQ(request.style.name, "night");
    EXPECT_EQ(request.style.query(), "style=night&b.fill=ff0000ff");
    EXPECT_EQ(request.scale, 2);
  }
  const auto status_of = [&book](const char* target) {
    const auto parsed = parse_tiles_target(split_target(target).value(), book);
    return parsed ? 200 : parsed.problem().status;
  };
  EXPECT_EQ(status_of("/tiles/a/s/night.json"), 200);
  EXPECT_EQ(status_of("/tiles/a/s/default@4x.json"), 200);
  EXPECT_EQ(status_of("/tiles/a/s/day.json"), 404);
  EXPECT_EQ(status_of("/tiles/a/s/.json"), 404);
  for (const char* target : {"/tiles/a@5x.json", "/tiles/a@.json", "/tiles/a@2x@2x.json",
                             "/tiles/@2x.json", "/tiles/a@2x.json?fill=no"}) {
    EXPECT_EQ(status_of(target), 400) << target;
  }
}

TEST(TileRequestTest, TellsWhereTilesOfOtherSetsAreDescribed) {
  const auto parsed =
      parse_tiles_target(split_target("/tiles/a/WorldCRS84Quad.json").value(), StyleBook());
  ASSERT_FALSE(parsed);
  EXPECT_EQ(parsed.problem().status, 400);
  EXPECT_THAT(parsed.problem().detail,
              ::testing::HasSubstr("/ogc/collections/{layer}/map/tiles/WorldCRS84Quad"));
  EXPECT_EQ(status_of("/tiles/a/NoSuchSet.json"), 404);
}

TEST(TileRequestTest, TakesTheCornersOfTheMatrixAndNothingBeyond) {
  EXPECT_EQ(status_of("/tiles/a/24/16777215/16777215.png"), 200);
  for (const char* tile : {"24/16777216/0", "24/0/16777216", "0/1/0", "0/0/1", "25/0/0", "3/8/0",
                           "32/0/0", "64/0/0", "-1/0/0", "3/-1/0", "3/0/-1", "3/4294967296/0",
                           "4294967296/0/0", "3/99999999999999999999999/0"}) {
    EXPECT_EQ(status_of(std::string("/tiles/a/") + tile + ".png"), 404) << tile;
  }
}

TEST(TileRequestTest, RefusesWhatIsMalformed) {
  for (const char* target : {"/tiles/a/z/0/0.png",
                             "/tiles/a//0/0.png",
                             "/tiles/a/0//0.png",
                             "/tiles/a/0/0/.png",
                             "/tiles/a/00/0/0.png",
                             "/tiles/a/1/01/0.png",
                             "/tiles/a/+1/0/0.png",
                             "/tiles/a/1e9/0/0.png",
                             "/tiles/a/0x1/0/0.png",
                             "/tiles/a/1.0/0/0.png",
                             "/tiles/a/%201/0/0.png",
                             "/tiles/a/-/0/0.png",
                             "/tiles/a/0/0/0",
                             "/tiles/a/0/0/0.jpg",
                             "/tiles/a/0/0/0.PNG",
                             "/tiles/a/0/0/0.png.png",
                             "/tiles/a/0/0/0@.png",
                             "/tiles/a/0/0/0@0x.png",
                             "/tiles/a/0/0/0@5x.png",
                             "/tiles/a/0/0/0@22x.png",
                             "/tiles/a/0/0/0@2.png",
                             "/tiles/a/0/0/0@2x@2x.png",
                             "/tiles//0/0/0.png",
                             "/tiles/a,/0/0/0.png",
                             "/tiles/,a/0/0/0.png",
                             "/tiles/a,,b/0/0/0.png",
                             "/tiles/a%00/0/0/0.png",
                             "/tiles/a%0d%0aX:y/0/0/0.png",
                             "/tiles/%/0/0/0.png",
                             "/tiles/a/0/0/0%.png",
                             "/tiles/a/0/0/0.png?%",
                             "/tiles/a/0/0/0.png?fill=%f",
                             "/tiles/a.b/0/0/0.png",
                             "/tiles/a%2Fb/0/0/0.png",
                             "/tiles/..%2F..%2Fetc/0/0/0.png",
                             "/tiles/r\xc3\xa4uber/0/0/0.png",
                             "/tiles/.json",
                             "/tiles/a,.json"}) {
    EXPECT_EQ(status_of(target), 400) << target;
  }
}

TEST(TileRequestTest, KnowsNoOtherPaths) {
  for (const char* target : {"/tiles/", "/tiles/a", "/tiles/a/0/0.png", "/tiles/a/0/0/0/0.png",
                             "/tiles/../a/0/0/0.png/"}) {
    EXPECT_EQ(status_of(target), 404) << target;
  }
}

TEST(TileRequestTest, RefusesLayerNamesThatAreTooLongOrTooMany) {
  EXPECT_EQ(status_of("/tiles/" + std::string(64, 'a') + "/0/0/0.png"), 200);
  EXPECT_EQ(status_of("/tiles/" + std::string(65, 'a') + "/0/0/0.png"), 400);
  std::string sixteen = "a0";
  for (int i = 1; i < 16; ++i) sixteen += ",a" + std::to_string(i);
  EXPECT_EQ(status_of("/tiles/" + sixteen + "/0/0/0.png"), 200);
  EXPECT_EQ(status_of("/tiles/" + sixteen + ",a0/0/0/0.png"), 200);
  EXPECT_EQ(status_of("/tiles/" + sixteen + ",b/0/0/0.png"), 400);
}

}  // namespace
}  // namespace trapeze
