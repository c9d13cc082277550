// Maps, tiles and features of layers that are built for other reference systems.
#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/io/prepared/prepared_layer.h"
#include "core/io/source/target_grid.h"
#include "render/picture/png.h"
#include "server/config/load_config.h"
#include "server/tiles/open_fonts.h"
#include "server/tiles/read_tile_matrix_set.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/service/sample_picture.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A square in the Swiss grid, 100 km wide and high; a feature of two polygons that meet at 180
/// degrees; and land around the South Pole, cut at 180 degrees, which is usual in such data.
constexpr const char* kSwiss = R"({"type":"FeatureCollection",
"crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::2056"}},"features":[
{"type":"Feature","properties":{"name":"square"},"geometry":{"type":"Polygon","coordinates":
[[[2600000,1150000],[2700000,1150000],[2700000,1250000],[2600000,1250000],[2600000,1150000]]]}}]})";
constexpr const char* kSeam = R"({"type":"FeatureCollection","features":[
{"type":"Feature","properties":{"name":"island"},"geometry":{"type":"MultiPolygon","coordinates":
[[[[178,-18],[180,-18],[180,-16],[178,-16],[178,-18]]],
[[[-180,-18],[-178,-18],[-178,-16],[-180,-16],[-180,-18]]]]}},
{"type":"Feature","properties":{"name":"pole"},"geometry":{"type":"Polygon","coordinates":
[[[-180,-90],[180,-90],[180,-88],[120,-87.5],[60,-88],[0,-87.8],[-60,-88.2],[-120,-87.9],
[-180,-88],[-180,-90]]]}}]})";

class GridsTest : public ::testing::Test {
 protected:
  GridsTest() : swiss_(file("swiss.geojson", kSwiss)), seam_(file("seam.geojson", kSeam)) {
    layers_ = layers_of_files({swiss_, seam_});
    layers_[0].crs = {"EPSG:3857", "EPSG:2056"};
    layers_[1].crs = {"EPSG:3857", "EPSG:5042", "EPSG:32760"};
    for (LayerConfig& layer : layers_) layer.style = testing::style_of("fill=f00");
    sample_.data().set(Dataset::load(layers_));
  }
  std::string file(const std::string& name, const char* text) {
    const std::string path = folder_.file(name);
    std::ofstream(path) << text;
    return path;
  }
  static SiteOptions options() {
    SiteOptions options;
    options.map_pixels = std::uint64_t{1} << 22;
    options.fonts = open_fonts({});
    options.sets = std::make_shared<const TileMatrixSets>(
        tile_matrix_sets_with({TRAPEZE_CONFIG_FOLDER "/tile_matrix_sets/swiss_lv95.json"}));
    return options;
  }
  Picture picture(const std::string& target) { return testing::picture_of(sample_, target); }
  void expect_same(const std::string& a, const std::string& b) {
    const HttpResponse one = sample_.get(a);
    ASSERT_EQ(one.status, 200) << a << " " << *one.body;
    EXPECT_EQ(*one.body, *sample_.get(b).body) << a << "\n" << b;
  }
  TemporaryFolder folder_;
  std::string swiss_;
  std::string seam_;
  std::vector<LayerConfig> layers_;
  testing::SampleSite sample_{false, {}, options()};
};

TEST_F(GridsTest, ASquareOfTheSystemIsASquare) {
  const Picture map = picture(
      "/map/swiss.png?crs=EPSG:2056&bbox=2590000,1140000,2710000,1260000&width=120&height=120"
      "&quality=exact");
  for (int i = 10; i < 110; ++i) {
    EXPECT_EQ(map.at(i, 10).a, 255) << i;
    EXPECT_EQ(map.at(i, 9).a, 0) << i;
    EXPECT_EQ(map.at(i, 109).a, 255) << i;
    EXPECT_EQ(map.at(i, 110).a, 0) << i;
    EXPECT_EQ(map.at(10, i).a, 255) << i;
    EXPECT_EQ(map.at(9, i).a, 0) << i;
    EXPECT_EQ(map.at(110, i).a, 0) << i;
  }
}

TEST_F(GridsTest, TilesAreThoseOfTheSet) {
  // Matrix 17 has pixels of 100 m; tile 7/3 begins at 2,599,200 and 1,273,200.
  const Picture tile = picture("/tiles/swiss/SwissLV95/17/7/3.png?quality=exact");
  EXPECT_EQ(tile.at(7, 240).a, 0);
  EXPECT_EQ(tile.at(8, 240).a, 255);
  EXPECT_EQ(tile.at(100, 231).a, 0);
  EXPECT_EQ(tile.at(100, 232).a, 255);
  expect_same("/tiles/swiss/SwissLV95/17/7/3.png",
              "/map/swiss.png?crs=EPSG:2056&bbox=2599200,1247600,2624800,1273200&width=256");
  expect_same("/wmts/swiss/default/SwissLV95/17/3/7.png", "/tiles/swiss/SwissLV95/17/7/3.png");
  expect_same("/ogc/collections/swiss/map/tiles/SwissLV95/17/3/7",
              "/tiles/swiss/SwissLV95/17/7/3.png");
  expect_same(
      "/wms?VERSION=1.3.0&REQUEST=GetMap&LAYERS=swiss&STYLES=&CRS=EPSG:2056&WIDTH=256&HEIGHT=256&"
      "BBOX=2599200,1247600,2624800,1273200&FORMAT=image/png&TRANSPARENT=TRUE",
      "/tiles/swiss/SwissLV95/17/7/3.png");
  EXPECT_EQ(sample_.get("/tiles/swiss/SwissLV95/17/1000/3.png").status, 404);
  EXPECT_EQ(sample_.get("/tiles/swiss/SwissLV95/99/0/0.png").status, 404);
  EXPECT_NE(sample_.get("/tiles/swiss/SwissLV95/17/7/3.png").header("ETag"),
            sample_.get("/tiles/swiss/SwissLV95/17/7/4.png").header("ETag"));
}

TEST_F(GridsTest, WhatIsNotBuiltIsRefusedWithTheNamesOfWhatIs) {
  for (const char* target :
       {"/map/seam.png?crs=EPSG:2056&bbox=2500000,1100000,2600000,1200000",
        "/tiles/seam/SwissLV95/17/7/3.png",
        "/wms?VERSION=1.3.0&REQUEST=GetMap&LAYERS=seam&STYLES=&CRS=EPSG:2056&WIDTH=256&HEIGHT=256&"
        "BBOX=2500000,1100000,2600000,1200000&FORMAT=image/png"}) {
    const auto response = sample_.get(target);
    EXPECT_EQ(response.status, 400) << target;
    EXPECT_THAT(*response.body,
                HasSubstr("not built for EPSG:2056, only for EPSG:3857, CRS:84, EPSG:4326, "
                          "EPSG:5042, EPSG:32760"))
        << target;
  }
  EXPECT_EQ(sample_.get("/ogc/collections/seam/map/tiles/SwissLV95").status, 404);
  EXPECT_EQ(sample_.get("/wmts/seam/default/SwissLV95/17/3/7.png").status, 404);
  EXPECT_EQ(
      sample_.get("/map/seam,swiss.png?crs=EPSG:2056&bbox=2500000,1100000,2600000,1200000").status,
      400);
}

TEST_F(GridsTest, DocumentsListWhatIsBuilt) {
  const std::string wms = *sample_.get("/wms?service=WMS&request=GetCapabilities").body;
  EXPECT_THAT(wms, HasSubstr("<CRS>EPSG:2056</CRS>"));
  EXPECT_THAT(wms, HasSubstr(R"(<BoundingBox CRS="EPSG:2056" minx="2600000.00)"));
  const std::string wmts = *sample_.get("/wmts.xml").body;
  EXPECT_THAT(wmts, HasSubstr("<ows:Identifier>SwissLV95</ows:Identifier>"));
  EXPECT_THAT(wmts, HasSubstr("<ows:SupportedCRS>urn:ogc:def:crs:EPSG::2056</ows:SupportedCRS>"));
  EXPECT_THAT(wmts, HasSubstr("<TopLeftCorner>2420000 1350000</TopLeftCorner>"));
  EXPECT_THAT(wmts, HasSubstr("<ows:BoundingBox crs=\"urn:ogc:def:crs:EPSG::2056\">\n"
                              "        <ows:LowerCorner>2600000.00"));
  EXPECT_THAT(wmts, HasSubstr("UPSAntarcticWGS84Quad"));
  EXPECT_THAT(wmts, Not(HasSubstr("LAEAQuad")));
  const auto tilesets =
      nlohmann::json::parse(*sample_.get("/ogc/collections/swiss/map/tiles").body)["tilesets"];
  ASSERT_EQ(tilesets.size(), 3u);
  EXPECT_EQ(tilesets[2]["crs"], "http://www.opengis.net/def/crs/EPSG/0/2056");
  const auto crs = nlohmann::json::parse(*sample_.get("/ogc/collections/swiss").body)["crs"];
  EXPECT_EQ(crs.size(), 4u);
}

TEST_F(GridsTest, FeaturesAreFoundWhereTheyAreDrawn) {
  const std::string info =
      "/wms?VERSION=1.3.0&REQUEST=GetFeatureInfo&LAYERS=swiss&QUERY_LAYERS=swiss&STYLES=&"
      "CRS=EPSG:2056&BBOX=2590000,1140000,2710000,1260000&WIDTH=120&HEIGHT=120&INFO_FORMAT=";
  EXPECT_THAT(*sample_.get(info + "text/plain&I=10&J=10").body, HasSubstr("name = square"));
  EXPECT_THAT(*sample_.get(info + "text/plain&I=9&J=10").body, HasSubstr("nothing"));
  const auto json = nlohmann::json::parse(
      *sample_.get(info + "application/geo%2Bjson&I=50&J=50").body)["features"][0];
  EXPECT_NEAR(json["bbox"][0].get<double>(), 7.438, 0.02);
  EXPECT_NEAR(json["bbox"][3].get<double>(), 47.40, 0.02);
  EXPECT_THAT(*sample_.get("/wmts/swiss/default/SwissLV95/17/3/7/240/8.txt").body,
              HasSubstr("name = square"));
  EXPECT_THAT(*sample_.get("/wmts/swiss/default/SwissLV95/17/3/7/240/7.txt").body,
              HasSubstr("nothing"));
}

/// The target of a map around a place given in degrees, with outlines.
std::string map_around(const std::string& grid, double lon, double lat, double units,
                       const std::string& layer = "seam") {
  const auto target = find_target_grid(grid);
  GridTransform transform(*target);
  std::vector<double> x = {lon};
  std::vector<double> y = {lat};
  EXPECT_TRUE(transform.to_cells(x, y));
  const double east = target->middle_x + x[0] / target->cells_per_unit();
  const double north = target->middle_y - y[0] / target->cells_per_unit();
  return fmt::format(
      "/map/{}.png?crs={}&bbox={},{},{},{}&width=200&height=200&stroke=000&"
      "stroke-width=3",
      layer, grid, east - units, north - units, east + units, north + units);
}

/// The number of pixels that are not red.
int others_in(const Picture& map) {
  int others = 0;
  for (const Rgba& pixel : map.pixels) others += pixel != Rgba{255, 0, 0, 255};
  return others;
}

TEST_F(GridsTest, NoLineRunsAlongTheSeam) {
  const std::string around = "&width=200&height=200&stroke=000&stroke-width=3";
  for (const std::string& target :
       {map_around("EPSG:32760", 180, -17, 20'000), map_around("EPSG:5042", 180, -89, 50'000),
        map_around("EPSG:5042", 0, -90, 80'000),
        "/map/seam.png?crs=EPSG:4326&bbox=179.8,-17.2,180.2,-16.8" + around,
        "/map/seam.png?crs=CRS:84&bbox=-180.2,-17.2,-179.8,-16.8" + around,
        "/map/seam.png?crs=EPSG:3857&bbox=20017508,-1930000,20057508,-1890000" + around}) {
    EXPECT_EQ(others_in(picture(target)), 0) << target;
  }
  const Picture shore = picture(map_around("EPSG:5042", 60, -88, 60'000));
  int lines = 0;
  for (int i = 0; i < 200; ++i) lines += shore.at(i, 100) == Rgba{0, 0, 0, 255};
  EXPECT_GT(lines, 0) << "there is no outline at all";
}

/// A cape in the east of Russia, in two polygons as sources have it.
constexpr const char* kCape = R"({"type":"FeatureCollection","features":[
{"type":"Feature","properties":{"name":"cape"},"geometry":{"type":"MultiPolygon","coordinates":
[[[[170,62],[175,64],[180,65.2],[180,69],[171,70],[160,69],[170,62]]],
[[[-180,65.2],[-176,65.5],[-170,66],[-175,68],[-180,69],[-180,65.2]]]]}}]})";

TEST_F(GridsTest, WhatCrossesTheAntimeridianIsWholeInEqualAreas) {
  layers_ = layers_of_files({file("cape.geojson", kCape)});
  layers_[0].crs = {"EPSG:3857", "EPSG:3571"};
  layers_[0].style = testing::style_of("fill=f00");
  sample_.data().set(Dataset::load(layers_));
  for (const double lat : {65.5, 66.5, 67.5, 68.7}) {
    const std::string target = map_around("EPSG:3571", 180, lat, 10'000, "cape");
    EXPECT_EQ(others_in(picture(target)), 0) << target;
  }
  // The cape is one piece from end to end, with sea around it.
  for (double lon = 166; lon < 188; lon += 1) {
    const Picture map = picture(map_around("EPSG:3571", lon, 67, 2'000, "cape"));
    EXPECT_EQ(map.at(100, 100), (Rgba{255, 0, 0, 255})) << lon;
  }
  for (const double lat : {64.5, 69.7}) {
    EXPECT_EQ(picture(map_around("EPSG:3571", 180, lat, 2'000, "cape")).at(100, 100).a, 0) << lat;
  }
}

/// A tile of a set in config/tile_matrix_sets, for a source with a square in the same reference
/// system.
struct Survey {
  const char* file;
  const char* set;
  int code;
  const char* matrix;
  double west;  // of the matrix, as in the set
  double north;
  double cell;
  int column;
  int row;
};

TEST_F(GridsTest, TilesOfTheSurveysOfOtherCountriesAreWhereTheyShouldBe) {
  const std::vector<Survey> surveys = {
      {"british_national_grid", "BritishNationalGrid", 27700, "7", -238375, 1376256, 7, 428, 667},
      {"dutch_rd", "DutchRD", 28992, "9", -285401.92, 903401.92, 6.72, 256, 256},
      {"german_utm32", "GermanUTM32", 25832, "9", -46133.17, 6301219.54, 9.55462853564703, 223,
       286},
  };
  for (const Survey& survey : surveys) {
    // The square covers pixels 64 to 192 of the tile in both directions.
    const double west = survey.west + (survey.column * 256 + 64) * survey.cell;
    const double north = survey.north - (survey.row * 256 + 64) * survey.cell;
    const double east = west + 128 * survey.cell;
    const double south = north - 128 * survey.cell;
    const std::string source = folder_.file(std::string(survey.set) + ".geojson");
    std::ofstream(source) << fmt::format(
        R"({{"type":"FeatureCollection","crs":{{"type":"name","properties":)"
        R"({{"name":"urn:ogc:def:crs:EPSG::{0}"}}}},"features":[{{"type":"Feature",)"
        R"("properties":{{}},"geometry":{{"type":"Polygon","coordinates":[[[{1:.6f},{2:.6f}],)"
        R"([{3:.6f},{2:.6f}],[{3:.6f},{4:.6f}],[{1:.6f},{4:.6f}],[{1:.6f},{2:.6f}]]]}}}}]}})",
        survey.code, west, south, east, north);
    layers_ = layers_of_files({source});
    layers_[0].name = "square";
    layers_[0].crs = {"EPSG:3857", fmt::format("EPSG:{}", survey.code)};
    layers_[0].style = testing::style_of("fill=f00");
    SiteOptions own = options();
    own.sets = std::make_shared<const TileMatrixSets>(tile_matrix_sets_with(
        {fmt::format("{}/tile_matrix_sets/{}.json", TRAPEZE_CONFIG_FOLDER, survey.file)}));
    testing::SampleSite site(false, {}, own);
    site.data().set(Dataset::load(layers_));
    const std::string tile =
        fmt::format("{}/{}/{}/{}", survey.set, survey.matrix, survey.column, survey.row);
    const Picture map = testing::picture_of(site, "/tiles/square/" + tile + ".png?quality=exact");
    ASSERT_EQ(map.width, 256) << tile;
    for (int i = 0; i < 256; ++i) {
      const bool is_within = i >= 64 && i < 192;
      EXPECT_NEAR(map.at(i, 64).a, is_within ? 255 : 0, 1) << tile << " " << i;
      EXPECT_NEAR(map.at(i, 191).a, is_within ? 255 : 0, 1) << tile << " " << i;
      EXPECT_NEAR(map.at(64, i).a, is_within ? 255 : 0, 1) << tile << " " << i;
      EXPECT_NEAR(map.at(191, i).a, is_within ? 255 : 0, 1) << tile << " " << i;
      EXPECT_NEAR(map.at(i, 63).a, 0, 1) << tile << " " << i;
      EXPECT_NEAR(map.at(i, 192).a, 0, 1) << tile << " " << i;
    }
    const std::string wmts = fmt::format("/wmts/square/default/{}/{}/{}/{}.png", survey.set,
                                         survey.matrix, survey.row, survey.column);
    EXPECT_EQ(*site.get(wmts).body, *site.get("/tiles/square/" + tile + ".png").body) << tile;
  }
}

TEST_F(GridsTest, ReadingAgainKeepsWhatHasNotChanged) {
  const auto before = sample_.data().get();
  const auto after = Dataset::load(layers_, before.get());
  ASSERT_EQ(after->layers().size(), 2u);
  ASSERT_EQ(after->layers_on_all_grids().size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(after->layers_on_all_grids()[i].layer, before->layers_on_all_grids()[i].layer);
  }
  layers_[0].crs = {};
  const auto fewer = Dataset::load(layers_, after.get());
  EXPECT_EQ(fewer->layers_on_all_grids().size(), 4u);
  EXPECT_NE(fewer->generation(), after->generation());
  EXPECT_THAT(fewer->grids(), ::testing::ElementsAre("EPSG:5042", "EPSG:32760"));
}

TEST_F(GridsTest, PreparedLayersAreForTheirGridOnly) {
  const std::string prepared = folder_.file("swiss.trapeze");
  const SourceStamp source = stamp_source(swiss_);
  for (const std::string grid : {"", "EPSG:2056"}) {
    LoadOptions how;
    how.grid = grid;
    const LoadedLayer loaded = load_layer(swiss_, how);
    save_prepared_layer(grid.empty() ? prepared : prepared_on_grid(prepared, grid), loaded,
                        revision_of(*loaded.layer), source, grid);
  }
  EXPECT_EQ(prepared_on_grid(prepared, "EPSG:2056"), folder_.file("swiss.EPSG-2056.trapeze"));
  EXPECT_THROW(open_prepared_layer(prepared_on_grid(prepared, "EPSG:2056")), std::runtime_error);
  PreparedDemands demands;
  demands.grid = "EPSG:2056";
  EXPECT_THROW(open_prepared_layer(prepared, demands), std::runtime_error);
  layers_[0].prepared = prepared;
  const std::string map =
      "/map/swiss.png?crs=EPSG:2056&bbox=2590000,1140000,2710000,1260000&width=120";
  const std::string built = *sample_.get(map).body;
  sample_.data().set(Dataset::load(layers_));
  EXPECT_NE(sample_.data().get()->layers_on_all_grids()[2].file, nullptr);
  EXPECT_EQ(*sample_.get(map).body, built);
}

TEST_F(GridsTest, TheConfigurationIsChecked) {
  const auto problems_of = [this](const std::string& settings) {
    const std::string path = folder_.file("trapeze.toml");
    std::ofstream(path) << "[[layer]]\nname = \"swiss\"\nfile = \"" << swiss_ << "\"\n" << settings;
    std::string all;
    for (const ConfigProblem& problem : load_config(path, {}).problems) all += problem.what + "\n";
    return all;
  };
  EXPECT_EQ(problems_of("crs = [\"EPSG:3857\", \"EPSG:2056\"]\n"), "");
  EXPECT_THAT(problems_of("crs = [\"EPSG:2056\"]\n"), HasSubstr("EPSG:3857 must be in the list"));
  EXPECT_THAT(problems_of("crs = [\"EPSG:3857\", \"EPSG:3857\"]\n"), HasSubstr("named twice"));
  EXPECT_THAT(problems_of("crs = [\"EPSG:3857\", \"EPSG:4326\"]\n"), HasSubstr("needs no grid"));
  EXPECT_THAT(problems_of("crs = [\"EPSG:3857\", \"EPSG:99999\"]\n"), HasSubstr("PROJ"));
  EXPECT_THAT(problems_of("crs = [\"EPSG:3857\", \"EPSG:2056\"]\nclose_gaps = 1\n"),
              HasSubstr("one system only"));
}

}  // namespace
}  // namespace trapeze
