// Maps of OGC API - Maps.
#include "server/documents/ogc_map.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "core/layer/layer_builder.h"
#include "render/picture/png.h"
#include "render/picture/webp.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;

class OgcMapTest : public ::testing::Test {
 protected:
  testing::SampleSite sample_;
};

TEST_F(OgcMapTest, IsThePictureOfTheWindow) {
  const auto map =
      sample_.get("/ogc/collections/rings/map?bbox=-45,-30,60,50&width=300&height=200");
  ASSERT_EQ(map.status, 200) << *map.body;
  EXPECT_EQ(*map.body, *sample_.get("/map/rings.png?bbox=-45,-30,60,50&width=300&height=200").body);
  EXPECT_EQ(map.header("Content-Crs"), "<http://www.opengis.net/def/crs/EPSG/0/3857>");
  EXPECT_THAT(std::string(map.header("Content-Bbox")), ::testing::StartsWith("-5009377.08"));
  const auto in_metres = sample_.get(
      "/ogc/collections/rings/map?bbox=0,0,5000000,4000000&width=500&bbox-crs="
      "http://www.opengis.net/def/crs/EPSG/0/3857&crs=http://www.opengis.net/def/crs/EPSG/0/3857");
  EXPECT_EQ(*in_metres.body,
            *sample_.get("/map/rings.png?bbox=0,0,5000000,4000000&crs=EPSG:3857&width=500").body);
}

TEST_F(OgcMapTest, ShowsAllWithoutABox) {
  const Picture map = decode_png(*sample_.get("/ogc/collections/rings/map").body);
  EXPECT_EQ(map.width, 1024);
  EXPECT_EQ(map.height, 1024);
  EXPECT_EQ(map.at(2, 2).a, 255) << "the rings fill their bounds but for a hole";
  EXPECT_EQ(map.at(300, 512).a, 0);
  const Picture all = decode_png(*sample_.get("/ogc/map").body);
  EXPECT_EQ(all.width, 768) << "from the west of the world to 90 degrees east";
  EXPECT_EQ(all.height, 1024);
}

TEST_F(OgcMapTest, WithoutABoxIsNotBeyondTheLastZoom) {
  std::vector<LayerBuilder> builders(1);
  Rings rings;
  rings.add(std::vector<Point>{{0, 0}, {9, 0}, {9, 9}, {0, 9}});
  builders.front().add(0, rings);
  FeatureTable features{std::vector<Field>{}};
  features.append(1, std::vector<Value>{});
  ServedLayer served;
  served.config.name = "dot";
  served.layer = LayerBuilder::join(builders, std::move(features));
  sample_.data().set(std::make_shared<const Dataset>(std::vector<ServedLayer>{served}));
  for (const std::string query :
       {"", "?width=4096", "?height=30", "?width=300&height=20", "?crs=EPSG:4326"}) {
    const auto map = sample_.get("/ogc/collections/dot/map" + query);
    ASSERT_EQ(map.status, 200) << query << *map.body;
    const Picture picture = decode_png(*map.body);
    EXPECT_GT(picture.at(picture.width / 2, picture.height / 2).a, 100) << query;
  }
  SiteOptions options;
  options.max_zoom = 2;
  testing::SampleSite coarse(true, {}, options);
  const auto map = coarse.get("/ogc/collections/rings/map");
  ASSERT_EQ(map.status, 200) << *map.body;
  EXPECT_EQ(decode_png(*map.body).at(2, 2).a, 0) << "beside the rings";
  EXPECT_EQ(decode_png(*map.body).at(512, 512).a, 255);
  EXPECT_EQ(coarse.get("/ogc/collections/rings/map?bbox=-90,-60,90,60").status, 400);
}

TEST_F(OgcMapTest, OfTheDatasetHasTheCollectionsThatAreAskedFor) {
  const std::string rest = "bbox=-45,-30,60,50&width=300";
  EXPECT_EQ(*sample_.get("/ogc/map?collections=west,rings&" + rest).body,
            *sample_.get("/map/west,rings.png?" + rest).body);
  EXPECT_EQ(*sample_.get("/ogc/map?" + rest).body,
            *sample_.get("/map/rings,west.png?" + rest).body);
  EXPECT_EQ(sample_.get("/ogc/map?collections=cake&" + rest).status, 404);
}

TEST_F(OgcMapTest, BackgroundIsAsTheStandardHasIt) {
  const std::string map = "/ogc/collections/rings/map?bbox=-170,-10,-160,10&width=20";
  const auto colour = [&](const std::string& query) {
    return decode_png(*sample_.get(map + query).body).at(0, 0);
  };
  EXPECT_EQ(colour("").a, 0);
  EXPECT_EQ(colour("&transparent=false"), (Rgba{255, 255, 255, 255}));
  EXPECT_EQ(colour("&bgcolor=0x00FF00"), (Rgba{0, 255, 0, 255}));
  EXPECT_EQ(colour("&bgcolor=green"), (Rgba{0, 128, 0, 255}));
  EXPECT_EQ(colour("&bgcolor=0x00FF00&transparent=true").a, 0);
  EXPECT_EQ(colour("&bgcolor=0x00FF00&background=blue"), (Rgba{0, 0, 255, 255}));
}

TEST_F(OgcMapTest, FormatsAreThoseThatThereAre) {
  const std::string map = "/ogc/collections/rings/map?bbox=-170,-10,-160,10&width=20&f=";
  EXPECT_EQ(sample_.get(map + "png").header("Content-Type"), "image/png");
  EXPECT_EQ(sample_.get(map + "gif").status, 400);
  EXPECT_EQ(sample_.get(map + "webp").status, has_webp() ? 200 : 400);
}

TEST_F(OgcMapTest, IsLinkedToAndConformsToWhatHolds) {
  const std::string relation = "http://www.opengis.net/def/rel/ogc/1.0/map";
  for (const char* target : {"/ogc", "/ogc/collections/rings"}) {
    const auto links = nlohmann::json::parse(*sample_.get(target).body)["links"];
    const auto link =
        std::ranges::find_if(links, [&](const auto& l) { return l["rel"] == relation; });
    ASSERT_NE(link, links.end()) << target;
    const std::string href = (*link)["href"];
    const auto map = sample_.get(href.substr(href.find("/ogc")));
    EXPECT_EQ(map.header("Content-Type"), "image/png");
  }
  EXPECT_THAT(*sample_.get("/ogc/conformance").body, HasSubstr("ogcapi-maps-1/1.0/conf/core"));
}

TEST_F(OgcMapTest, TellsWhatIsWrong) {
  const std::string map = "/ogc/collections/rings/map?";
  for (const char* query :
       {"bbox=1,2,3", "bbox=a,b,c,d", "bbox=3,2,3,4", "bbox-crs=EPSG:2056", "crs=EPSG:2056",
        "width=0", "width=99999", "bgcolor=cake", "transparent=maybe", "f=json", "cake=1",
        "bbox=0,0,1,1&width=16000&height=16000"}) {
    EXPECT_EQ(sample_.get(map + query).status, 400) << query;
  }
  EXPECT_EQ(sample_.get("/ogc/collections/cake/map").status, 404);
}

}  // namespace
}  // namespace trapeze
