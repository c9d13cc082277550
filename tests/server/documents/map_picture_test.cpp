#include "server/documents/map_picture.h"

#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <array>

#include "core/grid/web_mercator.h"
#include "render/picture/channels.h"
#include "render/picture/png.h"
#include "server/config/load_config.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/service/sample_picture.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;

/// The bbox of a tile, or of several tiles, in metres.
std::string bbox_of(const TileId& tile, int columns = 1, int rows = 1) {
  const auto west = static_cast<double>(tile.origin_x());
  const auto north = static_cast<double>(tile.origin_y());
  const auto side = static_cast<double>(tile.side());
  const GridPosition from = metres_from_grid(west, north + rows * side);
  const GridPosition to = metres_from_grid(west + columns * side, north);
  return fmt::format("bbox={},{},{},{}&crs=EPSG:3857", from.x, from.y, to.x, to.y);
}

int most_difference(const Picture& a, const Picture& b) {
  int most = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    most = std::max(most, difference(channels_of(a.pixels[i]), channels_of(b.pixels[i])).most);
  }
  return most;
}

class MapPictureTest : public ::testing::Test {
 protected:
  static SiteOptions options() {
    SiteOptions options;
    options.styles.emplace("night", testing::style_of("fill=navy"));
    options.map_pixels = std::uint64_t{1} << 22;
    return options;
  }
  Picture picture(const std::string& target) { return testing::picture_of(sample_, target); }
  testing::SampleSite sample_{true, {}, options()};
};

// Of tiles at both ends of the world, as of the window over the antimeridian.
TEST_F(MapPictureTest, OutlinesReachOverTheAntimeridian) {
  const TemporaryFolder folder;
  const std::string file = folder.write("coast.geojson", R"({"type": "MultiPolygon", "coordinates":
    [[[[150, 10], [179.9, 10], [179.9, 30], [150, 30], [150, 10]]],
     [[[-180, 40], [-150, 40], [-150, 60], [-180, 60], [-180, 40]]],
     [[[150, 40], [180, 40], [180, 70], [150, 50], [150, 40]]]]})");
  sample_.data().set(Dataset::load(layers_of_files({file})));
  for (const char* join : {"round", "bevel", "miter"}) {
    for (const int zoom : {1, 4}) {
      const std::string style =
          fmt::format("quality=exact&stroke=000&stroke-width=20&stroke-linejoin={}", join);
      const std::uint32_t last = (1u << zoom) - 1;
      const std::uint32_t y = zoom == 1 ? 0 : 6;
      const Picture west =
          picture(fmt::format("/tiles/coast/{}/{}/{}.png?{}", zoom, last, y, style));
      const Picture east = picture(fmt::format("/tiles/coast/{}/0/{}.png?{}", zoom, y, style));
      const Picture both = picture(fmt::format("/map/coast.png?{}&width=512&height=256&{}",
                                               bbox_of({zoom, last, y}, 2), style));
      ASSERT_EQ(both.width, 512);
      int inked = 0;
      for (int row = 0; row < 256; ++row) {
        for (int column = 0; column < 256; ++column) {
          const auto off = [](Rgba a, Rgba b) {
            return difference(channels_of(a), channels_of(b)).most;
          };
          ASSERT_LE(off(west.at(column, row), both.at(column, row)), 1)
              << join << " " << zoom << " " << column << " " << row;
          ASSERT_LE(off(east.at(column, row), both.at(column + 256, row)), 1)
              << join << " " << zoom << " " << column << " " << row;
        }
        const Rgba ink = east.at(2, row);
        inked += ink.r == 0 && ink.a > 40;  // lines of small polygons are lighter
      }
      EXPECT_GT(inked, 10) << "the coast is in the other half of the world";
    }
  }
}

TEST_F(MapPictureTest, TheWindowOfATileIsTheTile) {
  for (const char* style :
       {"", "stroke=000&stroke-width=3&stroke-dasharray=6,4", "pattern=hatch", "quality=exact"}) {
    for (const TileId tile : {TileId{0, 0, 0}, TileId{1, 0, 1}, TileId{3, 3, 4}}) {
      for (const int scale : {1, 2, 3, 4}) {
        const std::string suffix = scale == 1 ? "" : fmt::format("@{}x", scale);
        const auto of_tile = sample_.get(fmt::format("/tiles/rings,west/{}/{}/{}{}.png?{}", tile.z,
                                                     tile.x, tile.y, suffix, style));
        const auto of_window = sample_.get(fmt::format(
            "/map/rings,west{}.png?{}&width=256&height=256&{}", suffix, bbox_of(tile), style));
        ASSERT_EQ(of_window.status, 200) << *of_window.body;
        EXPECT_EQ(*of_window.body, *of_tile.body) << tile.z << " " << scale << " " << style;
        EXPECT_EQ(of_window.header("ETag"), of_tile.header("ETag"));
      }
    }
  }
}

TEST_F(MapPictureTest, AWindowOnTheGridOfTilesHasTheirPixels) {
  const TileId first{2, 1, 1};
  const Picture all = picture("/map/rings,west.png?" + bbox_of(first, 2, 2) +
                              "&width=512&height=512&quality=exact&stroke=000&stroke-width=2");
  ASSERT_EQ(all.width, 512);
  int most = 0;
  for (std::uint32_t child = 0; child < 4; ++child) {
    const Picture tile =
        picture(fmt::format("/tiles/rings,west/2/{}/{}.png?quality=exact&stroke=000&stroke-width=2",
                            1 + child % 2, 1 + child / 2));
    for (int y = 0; y < 256; ++y) {
      for (int x = 0; x < 256; ++x) {
        const Rgba there =
            all.at(static_cast<int>(child % 2) * 256 + x, static_cast<int>(child / 2) * 256 + y);
        most = std::max(most, difference(channels_of(tile.at(x, y)), channels_of(there)).most);
      }
    }
  }
  EXPECT_LE(most, 1);
}

TEST_F(MapPictureTest, DegreesAndMetresAndAPlaceSayTheSame) {
  const auto in_degrees =
      sample_.get("/map/rings.png?bbox=0,0,45,40.97989806962013&width=512&height=512");
  const auto in_metres =
      sample_.get("/map/rings.png?" + bbox_of({3, 4, 3}) + "&width=512&height=512");
  EXPECT_EQ(in_degrees.status, 200) << *in_degrees.body;
  EXPECT_EQ(*in_degrees.body, *in_metres.body);
  const auto place = lonlat_from_grid(static_cast<double>(TileId{3, 4, 3}.origin_x()) +
                                          static_cast<double>(TileId{3, 4, 3}.side()) / 2,
                                      static_cast<double>(TileId{3, 4, 3}.origin_y()) +
                                          static_cast<double>(TileId{3, 4, 3}.side()) / 2);
  const auto centred =
      sample_.get(fmt::format("/map/rings/{},{},4/512x512.png", place.lon, place.lat));
  EXPECT_EQ(*centred.body, *in_metres.body);
}

TEST_F(MapPictureTest, MissingSidesFollowFromTheBox) {
  const auto size = [this](const std::string& query) {
    const Picture picture = this->picture("/map/rings.png?bbox=-90,-45,90,45" + query);
    return std::array{picture.width, picture.height};
  };
  // 45 degrees are 0.8814 radians of Mercator.
  EXPECT_EQ(size("&width=200"), (std::array{200, 112}));
  EXPECT_EQ(size("&height=112"), (std::array{200, 112}));
  EXPECT_EQ(size(""), (std::array{1024, 575}));
  EXPECT_EQ(size("&width=10&height=300"), (std::array{10, 300}));
  EXPECT_EQ(picture("/map/rings@2x.png?bbox=-90,-45,90,45&width=200").width, 400);
}

TEST_F(MapPictureTest, IsStretchedToItsSize) {
  const TileId tile{1, 0, 0};
  const Picture square = picture("/tiles/rings/1/0/0@2x.png?quality=exact");
  const Picture wide =
      picture("/map/rings.png?" + bbox_of(tile) + "&width=512&height=128&quality=exact");
  ASSERT_EQ(wide.height, 128);
  // The sides of the rings are vertical: the mean of four rows equals one row of the stretched
  // picture.
  int most = 0;
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 512; ++x) {
      int sum = 0;
      for (int i = 0; i < 4; ++i) sum += square.at(x, 4 * y + i).a;
      most = std::max(most, std::abs(sum / 4 - wide.at(x, y).a));
    }
  }
  EXPECT_LE(most, 2);
}

TEST_F(MapPictureTest, TheWorldGoesOnBeyondTheAntimeridian) {
  auto layers = layers_of_files({testing::fixture("west.geojson")});
  sample_.data().set(Dataset::load(layers));
  // "west" covers the western half of the world.
  const Picture over = picture("/map/west.png?bbox=90,-40,-90,40&width=200&height=100&fill=f00");
  EXPECT_EQ(over.at(98, 50).a, 0);
  EXPECT_EQ(over.at(101, 50), (Rgba{255, 0, 0, 255}));
  const Picture same = picture("/map/west.png?bbox=90,-40,270,40&width=200&height=100&fill=f00");
  EXPECT_EQ(most_difference(over, same), 0);
  const Picture thrice =
      picture("/map/west.png?bbox=-540,-40,540,40&width=300&height=40&fill=f00&stroke=000");
  for (const int world : {0, 1, 2}) {
    EXPECT_EQ(thrice.at(world * 100 + 20, 20), (Rgba{255, 0, 0, 255})) << world;
    EXPECT_EQ(thrice.at(world * 100 + 80, 20).a, 0) << world;
  }
}

TEST_F(MapPictureTest, NothingShowsAlongTheSeam) {
  const TemporaryFolder folder;
  const std::string file = folder.write("world.geojson", R"({"type": "Polygon", "coordinates":
    [[[-180, -80], [180, -80], [180, 80], [-180, 80], [-180, -80]]]})");
  sample_.data().set(Dataset::load(layers_of_files({file})));
  // The seam is somewhere within a pixel.
  for (const char* east : {"-170.456", "-170.1", "-169.777"}) {
    const Picture over = picture(fmt::format(
        "/map/world.png?bbox=170.123,-20,{},20&width=333&height=9&fill=f00&stroke=000", east));
    for (int x = 0; x < over.width; ++x) {
      ASSERT_EQ(over.at(x, 5), (Rgba{255, 0, 0, 255})) << east << " " << x;
    }
  }
}

TEST_F(MapPictureTest, OffTheWorldThereIsNothing) {
  const Picture high = picture(
      "/map/west.png?bbox=-30000000,10000000,-10000000,40000000"
      "&crs=EPSG:3857&width=200&height=300&fill=f00&fill-opacity=1");
  EXPECT_EQ(high.at(150, 10).a, 0) << "north of the world";
  EXPECT_EQ(high.at(20, 299).a, 0) << "the east of the world before";
  EXPECT_EQ(high.at(150, 299), (Rgba{255, 0, 0, 255}));
}

TEST_F(MapPictureTest, StylesInThePathAreThoseOfTheQuery) {
  const auto by_path = sample_.get("/map/rings/s/night.png?bbox=-90,-45,90,45");
  const auto by_query = sample_.get("/map/rings.png?bbox=-90,-45,90,45&style=night");
  EXPECT_EQ(by_path.status, 200);
  EXPECT_EQ(*by_path.body, *by_query.body);
  const auto around = sample_.get("/map/rings/s/night/0,0,1/100x50@2x.png");
  EXPECT_EQ(around.status, 200);
  EXPECT_EQ(*around.body, *sample_.get("/map/rings/0,0,1/100x50@2x.png?style=night").body);
  EXPECT_EQ(sample_.get("/map/rings/s/day.png?bbox=-90,-45,90,45").status, 404);
}

TEST_F(MapPictureTest, WhoHasItIsNotSentItAgain) {
  const std::string target = "/map/rings.png?bbox=-90,-45,90,45&width=100";
  const auto first = sample_.get(target);
  EXPECT_EQ(sample_.get(target, std::string(first.header("ETag"))).status, 304);
}

TEST_F(MapPictureTest, TellsWhatIsWrong) {
  const std::pair<const char*, int> targets[] = {
      {"/map/rings.png", 400},
      {"/map/rings.png?bbox=", 400},
      {"/map/rings.png?bbox=1,2,3", 400},
      {"/map/rings.png?bbox=1,2,3,4,5", 400},
      {"/map/rings.png?bbox=1,2,x,4", 400},
      {"/map/rings.png?bbox=1,2,1,4", 400},
      {"/map/rings.png?bbox=1,4,2,2", 400},
      {"/map/rings.png?bbox=1,2,nan,4", 400},
      {"/map/rings.png?bbox=1,2,1e300,4", 400},
      {"/map/rings.png?bbox=1,2,3,91", 400},
      {"/map/rings.png?bbox=1,2,1.000000001,3", 400},
      {"/map/rings.png?bbox=1,86,2,87", 400},
      {"/map/rings.png?bbox=0,0,0.00001,0.00001&width=4000", 400},  // beyond the last zoom
      {"/map/rings.png?bbox=1,2,3,4&width=0", 400},
      {"/map/rings.png?bbox=1,2,3,4&width=-1", 400},
      {"/map/rings.png?bbox=1,2,3,4&width=1.5", 400},
      {"/map/rings.png?bbox=1,2,3,4&width=99999999999999999999", 400},
      {"/map/rings.png?bbox=1,2,3,4&width=16385", 400},
      {"/map/rings@4x.png?bbox=1,2,3,4&width=16384&height=1", 400},
      {"/map/rings.png?bbox=1,2,3,4&width=2049&height=2048", 400},
      {"/map/rings.png?bbox=1,2,3,4&crs=EPSG:2056", 400},
      {"/map/rings.png?bbox=1,2,3,4&fil=red", 400},
      {"/map/rings.gif?bbox=1,2,3,4", 400},
      {"/map/rings@5x.png?bbox=1,2,3,4", 400},
      {"/map/nothing.png?bbox=1,2,3,4", 404},
      {"/map/rings/0,0,25/10x10.png", 400},
      {"/map/rings/0,0/10x10.png", 400},
      {"/map/rings/0,86,1/10x10.png", 400},
      {"/map/rings/0,0,1/10.png", 400},
      {"/map/rings/0,0,1/10x.png", 400},
      {"/map/rings/0,0,1/0x10.png", 400},
      {"/map/rings/0,0,1/10x10x10.png", 400},
      {"/map/rings.png?bbox=1,2,3,4&width=5&width=6", 400},
      {"/map/rings.png?bbox=1,2,3,4&bbox=1,2,3,4", 400},
      {"/map/rings/s/night.png?bbox=1,2,3,4&style=night", 400},
      {"/map/rings/0,0,1/10x10.png?bbox=1,2,3,4", 400},
      {"/map/rings/0,0,1/10x10.png?width=5", 400},
      {"/map/rings/0,0,1/10x10.png?crs=EPSG:4326", 400},
      {"/map", 404},
      {"/map/rings/0,0,1", 404},
      {"/map/a/b/c/d/e/f", 404},
  };
  for (const auto& [target, status] : targets) {
    const auto response = sample_.get(target);
    EXPECT_EQ(response.status, status) << target;
    EXPECT_EQ(response.header("Content-Type"), "application/problem+json") << target;
  }
  EXPECT_THAT(*sample_.get("/map/rings.png?bbox=1,2,3,4&width=2049&height=2048").body,
              HasSubstr("at most 4194304 pixels"));
}

TEST_F(MapPictureTest, WhatIsWrongIsSaid) {
  for (const auto& [target, words] : std::vector<std::pair<std::string, std::string>>{
           {"/map/rings.gif?bbox=1,2,3,4", "/map/{layers}.png"},
           {"/map/rings.png?bbox=1,4,3,2", "south less than north"},
           {"/map/rings.png?bbox=1,86,3,87", "85.0511"},
           {"/map/rings/0,86,1/10x10.png", "latitude from -85.0511 to 85.0511"},
           {"/map/rings/0,0,25/10x10.png", "zoom from 0 to 24"},
           {"/map/rings/0,0,1/10x0.png", "from 1 to 16384"},
           {"/map/rings@4x.png?bbox=1,2,3,4&width=9&height=16384", "36 x 65536"},
           {"/map/rings/0,0,1/10x10.png?crs=EPSG:4326", "The parameter crs goes with a box"}}) {
    EXPECT_THAT(*sample_.get(target).body, HasSubstr(words)) << target;
  }
}

TEST_F(MapPictureTest, LargePicturesAreTheSameAsThoseInOnePiece) {
  // 1025 x 1024 pixels are drawn in bands; the same rows in a lower picture are not.
  const TileId tile{2, 1, 1};
  const Picture large = picture("/map/rings,west.png?" + bbox_of(tile) +
                                "&width=1024&height=1024&quality=exact&stroke=000&pattern=dots");
  const double side = static_cast<double>(tile.side());
  const auto metres = [&](double part_from, double part_to) {
    const auto west = static_cast<double>(tile.origin_x());
    const auto north = static_cast<double>(tile.origin_y());
    const GridPosition from = metres_from_grid(west, north + part_to * side);
    const GridPosition to = metres_from_grid(west + side, north + part_from * side);
    return fmt::format("bbox={},{},{},{}&crs=EPSG:3857", from.x, from.y, to.x, to.y);
  };
  const Picture part = picture("/map/rings,west.png?" + metres(0.125, 0.375) +
                               "&width=1024&height=256&quality=exact&stroke=000&pattern=dots");
  int most = 0;
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 1024; ++x) {
      most = std::max(
          most, difference(channels_of(part.at(x, y)), channels_of(large.at(x, y + 128))).most);
    }
  }
  EXPECT_LE(most, 1);
}

}  // namespace
}  // namespace trapeze
