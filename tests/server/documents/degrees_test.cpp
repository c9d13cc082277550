// Maps in degrees, EPSG:4326 and CRS:84, drawn from the graph of Web Mercator, through every
// interface that serves them.
#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

#include "render/picture/png.h"
#include "server/tiles/open_fonts.h"
#include "tests/server/service/sample_picture.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// In the sample, the outer ring reaches 66.5133 degrees north and south and 90 degrees west and
/// east; the hole reaches 40.9799 and 45 degrees.
constexpr const char* kWorld = "bbox=-180,-90,180,90&width=720&height=360";

std::string wms(const std::string& version, const std::string& system, const std::string& box) {
  return fmt::format(
      "/wms?SERVICE=WMS&VERSION={}&REQUEST=GetMap&LAYERS=rings&STYLES=&{}={}&BBOX={}&WIDTH=256&"
      "HEIGHT=256&FORMAT=image/png&TRANSPARENT=TRUE",
      version, version == "1.3.0" ? "CRS" : "SRS", system, box);
}

class DegreesTest : public ::testing::Test {
 protected:
  static SiteOptions options() {
    SiteOptions options;
    options.styles.emplace("night", testing::style_of("fill=navy"));
    options.map_pixels = std::uint64_t{1} << 22;
    options.fonts = open_fonts({});
    return options;
  }
  Picture picture(const std::string& target) { return testing::picture_of(sample_, target); }
  void expect_same(const std::string& a, const std::string& b) {
    const HttpResponse one = sample_.get(a);
    const HttpResponse other = sample_.get(b);
    ASSERT_EQ(one.status, 200) << a << " " << *one.body;
    EXPECT_EQ(*one.body, *other.body) << a << "\n" << b;
    EXPECT_EQ(one.header("ETag"), other.header("ETag")) << a << "\n" << b;
  }
  testing::SampleSite sample_{true, {}, options()};
};

TEST_F(DegreesTest, EveryDegreeIsAsHigh) {
  const Picture map = picture(std::string("/map/rings.png?crs=CRS:84&quality=exact&") + kWorld);
  ASSERT_EQ(map.width, 720);
  ASSERT_EQ(map.height, 360);
  const int column = 200;  // 80 degrees west, inside the ring
  EXPECT_EQ(map.at(column, 45).a, 0);
  EXPECT_NEAR(map.at(column, 46).a, 255 * 2 * (66.5133 - 66.5), 2);
  EXPECT_EQ(map.at(column, 47).a, 255);
  EXPECT_NEAR(map.at(360 + 80, 98).a, 255 * 2 * (41 - 40.9799), 2);
  EXPECT_EQ(map.at(360 + 80, 97).a, 255);
  EXPECT_EQ(map.at(360 + 80, 99).a, 0);
  EXPECT_EQ(map.at(180, 180).a, 255) << "the ring begins at 90 degrees west";
  EXPECT_EQ(map.at(179, 180).a, 0);
}

TEST_F(DegreesTest, BeyondTheMapOfWebMercatorThereIsNothing) {
  const Picture map = picture(
      std::string(
          "/map/west.png?crs=EPSG:4326&background=fff&fill=000&fill-opacity=1&quality=exact&") +
      kWorld);
  EXPECT_EQ(map.at(100, 8), (Rgba{255, 255, 255, 255}));  // 86 to 85.5 degrees
  EXPECT_EQ(map.at(100, 10), (Rgba{0, 0, 0, 255}));
  EXPECT_EQ(map.at(100, 349), (Rgba{0, 0, 0, 255}));
  EXPECT_EQ(map.at(100, 351), (Rgba{255, 255, 255, 255}));
  const Picture pole = picture("/map/west.png?crs=CRS:84&bbox=-180,86,180,90&width=64&height=64");
  EXPECT_EQ(pole.at(3, 3).a, 0);
  const Picture beyond =
      picture(wms("1.1.1", "EPSG:4326", "-180,-100,180,260") + "&fill=000&stroke=f00");
  EXPECT_EQ(beyond.at(128, 0).a, 0);
}

TEST_F(DegreesTest, TheWorldGoesOnBeyondTheAntimeridian) {
  const Picture around =
      picture("/map/west.png?crs=CRS:84&bbox=170,-10,-170,10&width=200&height=200&quality=exact");
  EXPECT_EQ(around.at(99, 100).a, 0);
  EXPECT_EQ(around.at(100, 100).a, 128);
  expect_same("/map/west.png?crs=CRS:84&bbox=170,-10,-170,10&width=200&height=200",
              "/map/west.png?crs=CRS:84&bbox=-190,-10,-170,10&width=200&height=200");
}

TEST_F(DegreesTest, WmsHasTheAxesInTheOrderOfTheVersion) {
  const std::string map = "/map/rings.png?crs=CRS:84&bbox=10,20,100,70&width=256&height=256";
  expect_same(wms("1.3.0", "EPSG:4326", "20,10,70,100"), map);
  expect_same(wms("1.3.0", "CRS:84", "10,20,100,70"), map);
  expect_same(wms("1.3.0", "crs:84", "10,20,100,70"), map);
  expect_same(wms("1.1.1", "EPSG:4326", "10,20,100,70"), map);
  expect_same("/map/rings.png?crs=EPSG:4326&bbox=10,20,100,70&width=256&height=256", map);
  const auto wrong = sample_.get(wms("1.3.0", "EPSG:4326", "70,10,20,100"));
  EXPECT_EQ(wrong.status, 400);
  EXPECT_THAT(*wrong.body, HasSubstr("south, west, north and east in degrees"));
}

TEST_F(DegreesTest, WmsTellsFeaturesUnderPixels) {
  const std::string info =
      "/wms?VERSION=1.3.0&REQUEST=GetFeatureInfo&LAYERS=rings&QUERY_LAYERS=rings&STYLES=&"
      "CRS=EPSG:4326&BBOX=-90,-180,90,180&WIDTH=720&HEIGHT=360&INFO_FORMAT=text/plain";
  EXPECT_THAT(*sample_.get(info + "&I=200&J=47").body, HasSubstr("layer = rings"));
  EXPECT_THAT(*sample_.get(info + "&I=200&J=46").body, HasSubstr("nothing"));
  EXPECT_THAT(*sample_.get(info + "&I=440&J=99").body, HasSubstr("nothing"));
  EXPECT_THAT(*sample_.get(info + "&I=440&J=1").body, HasSubstr("nothing"));
}

TEST_F(DegreesTest, CapabilitiesOfWmsNameTheSystems) {
  const std::string latest = *sample_.get("/wms?service=WMS&request=GetCapabilities").body;
  for (
      const char* part :
      {"<CRS>EPSG:3857</CRS>", "<CRS>CRS:84</CRS>", "<CRS>EPSG:4326</CRS>",
       R"(<BoundingBox CRS="EPSG:4326" minx="-66.51326040" miny="-90.00000000" maxx="66.51326040" maxy="90.00000000"/>)",
       R"(<BoundingBox CRS="CRS:84" minx="-90.00000000" miny="-66.51326040" maxx="90.00000000" maxy="66.51326040"/>)"}) {
    EXPECT_THAT(latest, HasSubstr(part));
  }
  const std::string old =
      *sample_.get("/wms?service=WMS&version=1.1.1&request=GetCapabilities").body;
  EXPECT_THAT(old, HasSubstr("<SRS>EPSG:4326</SRS>"));
  EXPECT_THAT(
      old,
      HasSubstr(
          R"(<BoundingBox SRS="EPSG:4326" minx="-90.00000000" miny="-66.51326040" maxx="90.00000000")"));
}

TEST_F(DegreesTest, OtherSystemsAreRefusedWithTheNamesOfThoseThatThereAre) {
  const auto of_map = sample_.get("/map/rings.png?crs=EPSG:2056&bbox=0,0,1,1");
  EXPECT_EQ(of_map.status, 400);
  EXPECT_THAT(*of_map.body, HasSubstr("EPSG:3857, CRS:84, EPSG:4326"));
  const auto of_wms = sample_.get(wms("1.3.0", "EPSG:2056", "0,0,1,1"));
  EXPECT_EQ(of_wms.status, 400);
  EXPECT_THAT(*of_wms.body, HasSubstr("InvalidCRS"));
  EXPECT_THAT(*of_wms.body, HasSubstr("EPSG:3857, CRS:84, EPSG:4326"));
  EXPECT_THAT(*sample_.get(wms("1.1.1", "EPSG:2056", "0,0,1,1")).body, HasSubstr("InvalidSRS"));
  const auto of_ogc = sample_.get(
      "/ogc/collections/rings/map?crs=http://www.opengis.net/def/crs/EPSG/0/2056&bbox=0,0,1,1");
  EXPECT_EQ(of_ogc.status, 400);
  EXPECT_THAT(*of_ogc.body, HasSubstr("http://www.opengis.net/def/crs/EPSG/0/4326"));
}

TEST_F(DegreesTest, MapsOfTheOgcAreInTheSystemThatIsAskedFor) {
  const std::string map = "/map/rings.png?crs=CRS:84&bbox=10,20,100,70&width=300";
  const std::string ogc = "/ogc/collections/rings/map?width=300&";
  const std::string uri = "http://www.opengis.net/def/crs/";
  expect_same(ogc + "bbox=10,20,100,70&crs=" + uri + "OGC/1.3/CRS84", map);
  expect_same(ogc + "bbox=10,20,100,70&crs=[EPSG:4326]", map);
  expect_same(ogc + "bbox=20,10,70,100&bbox-crs=" + uri + "EPSG/0/4326&crs=" + uri + "EPSG/0/4326",
              map);
  // A box in degrees for a map in metres, and the other way round.
  expect_same(ogc + "bbox=20,10,70,100&bbox-crs=" + uri + "EPSG/0/4326",
              "/map/rings.png?bbox=10,20,100,70&width=300");
  const auto response = sample_.get(ogc + "bbox=10,20,100,70&crs=" + uri + "EPSG/0/4326");
  EXPECT_EQ(response.header("Content-Crs"), "<" + uri + "EPSG/0/4326>");
  EXPECT_THAT(std::string(response.header("Content-Bbox")),
              ::testing::MatchesRegex("19.9999.*,10.0000.*,70.0000.*,100.0000.*"));
  const auto metres =
      sample_.get(ogc + "bbox=0,0,5009377.0857,4865942.2795&bbox-crs=[EPSG:3857]&crs=[OGC:CRS84]");
  ASSERT_EQ(metres.status, 200) << *metres.body;
  EXPECT_THAT(std::string(metres.header("Content-Bbox")),
              ::testing::MatchesRegex("0.0000000.*,0.0000000.*,45.0000.*,39.9999.*"));
  const auto collection = nlohmann::json::parse(*sample_.get("/ogc/collections/rings").body)["crs"];
  EXPECT_EQ(collection.size(), 3u);
}

TEST_F(DegreesTest, TilesOfWorldCrs84QuadAreWindowsOfTheMap) {
  for (const char* style :
       {"", "stroke=000&stroke-width=3&stroke-dasharray=6,4", "pattern=hatch"}) {
    expect_same(
        fmt::format("/tiles/rings,west/WorldCRS84Quad/2/4/0.png?{}", style),
        fmt::format("/map/rings,west.png?crs=CRS:84&bbox=0,45,45,90&width=256&height=256&{}",
                    style));
    expect_same(
        fmt::format("/tiles/rings,west/WorldCRS84Quad/0/1/0@2x.png?{}", style),
        fmt::format("/map/rings,west@2x.png?crs=CRS:84&bbox=0,-90,180,90&width=256&height=256&{}",
                    style));
  }
  expect_same("/tiles/rings/WebMercatorQuad/3/3/4.png", "/tiles/rings/3/3/4.png");
  expect_same("/tiles/rings/s/night/WorldCRS84Quad/1/1/0.png",
              "/tiles/rings/WorldCRS84Quad/1/1/0.png?style=night");
}

TEST_F(DegreesTest, TilesThatThereAreNotAreNotFound) {
  EXPECT_EQ(sample_.get("/tiles/rings/WorldCRS84Quad/0/1/0.png").status, 200);
  for (const char* tile : {"WorldCRS84Quad/0/0/1", "WorldCRS84Quad/0/2/0", "WorldCRS84Quad/24/0/0",
                           "WorldCRS84Quad/1/-1/0"}) {
    const auto response = sample_.get(fmt::format("/tiles/rings/{}.png", tile));
    EXPECT_EQ(response.status, 404) << tile;
    EXPECT_THAT(*response.body, HasSubstr("WorldCRS84Quad")) << tile;
  }
  EXPECT_EQ(sample_.get("/tiles/rings/WorldCRS84Quad/a/0/0.png").status, 404);
  EXPECT_EQ(sample_.get("/tiles/rings/WorldCRS84Quad/1/a/0.png").status, 400);
  const auto unknown = sample_.get("/tiles/rings/GoogleQuad/0/0/0.png");
  EXPECT_EQ(unknown.status, 404);
  EXPECT_THAT(*unknown.body, HasSubstr("/ogc/tileMatrixSets"));
}

TEST_F(DegreesTest, WmtsHasTilesInDegrees) {
  const std::string xml = *sample_.get("/wmts.xml").body;
  for (const char* part :
       {"<TileMatrixSet>WorldCRS84Quad</TileMatrixSet>",
        "<ows:Identifier>WorldCRS84Quad</ows:Identifier>",
        "<ows:SupportedCRS>urn:ogc:def:crs:OGC:1.3:CRS84</ows:SupportedCRS>",
        "<WellKnownScaleSet>urn:ogc:def:wkss:OGC:1.0:GoogleCRS84Quad</WellKnownScaleSet>",
        "<TopLeftCorner>-180 90</TopLeftCorner>"}) {
    EXPECT_THAT(xml, HasSubstr(part));
  }
  expect_same("/wmts/rings/default/WorldCRS84Quad/2/0/4.png",
              "/tiles/rings/WorldCRS84Quad/2/4/0.png");
  expect_same(
      "/wmts?SERVICE=WMTS&REQUEST=GetTile&VERSION=1.0.0&LAYER=rings&STYLE=default&FORMAT=image/png&"
      "TILEMATRIXSET=WorldCRS84Quad&TILEMATRIX=2&TILEROW=0&TILECOL=4",
      "/tiles/rings/WorldCRS84Quad/2/4/0.png");
  // With 180 degrees in 256 pixels, row 33 begins at 66.8 degrees and row 34 at 66.1.
  EXPECT_THAT(*sample_.get("/wmts/rings/default/WorldCRS84Quad/0/0/1/34/100.txt").body,
              HasSubstr("layer = rings"));
  EXPECT_THAT(*sample_.get("/wmts/rings/default/WorldCRS84Quad/0/0/1/32/100.txt").body,
              HasSubstr("nothing"));
  EXPECT_EQ(sample_.get("/wmts/rings/default/WorldCRS84Quad/2/0/0.png").status, 404)
      << "the layer has nothing there";
}

TEST_F(DegreesTest, OgcApiTilesHasTilesInDegrees) {
  const auto sets = nlohmann::json::parse(*sample_.get("/ogc/tileMatrixSets").body);
  ASSERT_EQ(sets["tileMatrixSets"].size(), 2u);
  EXPECT_EQ(sets["tileMatrixSets"][1]["id"], "WorldCRS84Quad");
  const auto set = nlohmann::json::parse(*sample_.get("/ogc/tileMatrixSets/WorldCRS84Quad").body);
  EXPECT_EQ(set["crs"], "http://www.opengis.net/def/crs/OGC/1.3/CRS84");
  EXPECT_EQ(set["orderedAxes"], nlohmann::json({"Lon", "Lat"}));
  const auto& first = set["tileMatrices"][0];
  EXPECT_EQ(first["matrixWidth"], 2);
  EXPECT_EQ(first["matrixHeight"], 1);
  EXPECT_DOUBLE_EQ(first["cellSize"], 180.0 / 256);
  EXPECT_NEAR(first["scaleDenominator"].get<double>(), 279541132.0143589, 1e-3);
  const auto tilesets =
      nlohmann::json::parse(*sample_.get("/ogc/collections/rings/map/tiles").body)["tilesets"];
  ASSERT_EQ(tilesets.size(), 2u);
  EXPECT_EQ(tilesets[1]["crs"], "http://www.opengis.net/def/crs/OGC/1.3/CRS84");
  EXPECT_EQ(sample_.get("/ogc/collections/rings/map/tiles/WorldCRS84Quad").status, 200);
  expect_same("/ogc/collections/rings/map/tiles/WorldCRS84Quad/2/0/4",
              "/tiles/rings/WorldCRS84Quad/2/4/0.png");
  EXPECT_EQ(sample_.get("/ogc/tileMatrixSets/CakeQuad").status, 404);
}

TEST_F(DegreesTest, PicturesHaveTagsOfTheirOwn) {
  const auto in_degrees = sample_.get("/tiles/rings/WorldCRS84Quad/2/4/0.png");
  const auto in_metres = sample_.get("/tiles/rings/3/4/2.png");
  EXPECT_NE(in_degrees.header("ETag"), in_metres.header("ETag"));
  EXPECT_EQ(
      sample_.get("/tiles/rings/WorldCRS84Quad/2/4/0.png", std::string(in_degrees.header("ETag")))
          .status,
      304);
}

// Large maps are drawn in bands, which must join without a visible seam.
TEST_F(DegreesTest, BandsAreWhatTheWholeIs) {
  const std::string style = "&stroke=000&stroke-width=2&quality=exact";
  const Picture large =
      picture("/map/rings.png?crs=CRS:84&bbox=-100,-70,100,70&width=2000&height=1400" + style);
  const Picture part =
      picture("/map/rings.png?crs=CRS:84&bbox=-100,-4.4,-60,30&width=400&height=344" + style);
  ASSERT_EQ(large.width, 2000);
  for (int row = 10; row < 334; row += 7) {
    for (int column = 10; column < 390; ++column) {
      ASSERT_EQ(large.at(column, 400 + row), part.at(column, row)) << column << " " << row;
    }
  }
}

TEST_F(DegreesTest, MarksForDebuggingAreWherePolygonsAre) {
  const Picture plain = picture(std::string("/map/rings.png?crs=CRS:84&") + kWorld);
  const Picture marked = picture(std::string("/map/rings.png?crs=CRS:84&debug=mesh&") + kWorld);
  // Along the northern side of the ring.
  EXPECT_NE(marked.at(300, 46), plain.at(300, 46));
  EXPECT_EQ(marked.at(300, 60), plain.at(300, 60));
}

}  // namespace
}  // namespace trapeze
