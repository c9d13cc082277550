// Tables of values on a site: posted, joined, drawn, shown in legends, and discarded.
#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>
#include <set>

#include "render/picture/png.h"
#include "server/config/load_config.h"
#include "server/data/named_tables.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr int kColumns = 8;

/// Columns 45 degrees wide, from west to east, with the codes C0 to C7 and the numbers 0 to 7.
std::string columns() {
  std::string features;
  for (int i = 0; i < kColumns; ++i) {
    const int west = -180 + 45 * i;
    features += fmt::format(
        R"({}{{"type": "Feature", "properties": {{"code": "C{}", "number": {}}}, "geometry":
        {{"type": "Polygon", "coordinates": [[[{}, -80], [{}, -80], [{}, 80], [{}, 80], [{}, -80]]]}}}})",
        i == 0 ? "" : ",", i, i, west, west + 45, west + 45, west, west);
  }
  return R"({"type": "FeatureCollection", "features": [)" + features + "]}";
}

class ValuesSiteTest : public ::testing::Test {
 protected:
  explicit ValuesSiteTest(std::size_t posted_values = std::size_t{16} << 20)
      : sample_(false, {}, options(posted_values)) {
    serve("code,people\nC0,10\nC1,20\nC2,30\nC3,40\n");
  }

  /// Serves the columns with a table from the configuration.
  void serve(const std::string& people) {
    const std::string file = folder_.write("columns.geojson", columns());
    auto layers = layers_of_files({file});
    layers[0].title = "Columns";
    ValueTableConfig table;
    table.file = folder_.write("people.csv", people);
    table.title = "People";
    table.attribution = "counted by hand";
    sample_.data().set(Dataset::load(layers, sample_.data().get().get(), nullptr,
                                     read_named_tables({{"people", table}})));
  }

  HttpResponse post(const std::string& body, const std::string& query = {},
                    const std::string& content_type = {}) {
    HttpRequest request{"POST", "/values" + query, "maps.example:8080", {}, body};
    request.content_type = content_type;
    return sample_.handle(request);
  }
  std::string id_of(const std::string& body) {
    const auto response = post(body);
    EXPECT_EQ(response.status, 201) << *response.body;
    return Json::parse(*response.body)["id"];
  }
  Json json(const std::string& target) {
    const auto response = sample_.get(target);
    EXPECT_EQ(response.status, 200) << target << ": " << *response.body;
    return Json::parse(*response.body);
  }
  /// The colour of column `i` in the tile of zoom 0.
  Rgba colour(const std::string& query, int i) {
    const auto response = sample_.get("/tiles/columns/0/0/0.png?quality=exact&" + query);
    EXPECT_EQ(response.status, 200) << query << ": " << *response.body;
    if (response.status != 200) return {};
    return decode_png(*response.body).at(256 / kColumns * i + 16, 128);
  }
  std::string words(const std::string& target, int status) {
    const auto response = sample_.get(target);
    EXPECT_EQ(response.status, status) << target;
    return *response.body;
  }

  TemporaryFolder folder_;
  testing::SampleSite sample_;

 private:
  static SiteOptions options(std::size_t posted_values) {
    SiteOptions options;
    options.values_rows = 100;
    options.posted_values = posted_values;
    options.styles.emplace("crowd", testing::style_of("values=people&color-by=value&breaks=equal:2&"
                                                      "ramp=Blues&no-data-color=red"));
    return options;
  }
};

TEST_F(ValuesSiteTest, LabelsSayInALanguageWhatTheTableHasInIt) {
  ValueTableConfig table;
  table.file = folder_.write("names.csv",
                             "code,name,name:de,name:cop\n"
                             "C0,Vienna,Wien,\u2c83\nC1,Graz,,\nC2,Bregenz,Bregenz,\n");
  table.languages = {"de", "cop"};
  const auto layers = layers_of_files({folder_.write("columns.geojson", columns())});
  sample_.data().set(Dataset::load(layers, sample_.data().get().get(), nullptr,
                                   read_named_tables({{"names", table}})));
  const std::string base = "/tiles/columns/0/0/0.png?values=names&label=value&label-size=8";
  const auto tile = [&](const std::string& query) {
    const auto response = sample_.get(base + query);
    EXPECT_EQ(response.status, 200) << query << ": " << *response.body;
    return decode_png(*response.body);
  };
  const Picture plain = tile("");
  const Picture german = tile("&label-language=de");
  const auto is_same = [&](const Picture& picture, int column) {
    for (int y = 0; y < 256; ++y) {
      for (int x = 256 / kColumns * column; x < 256 / kColumns * (column + 1); ++x) {
        if (picture.at(x, y) != plain.at(x, y)) return false;
      }
    }
    return true;
  };
  EXPECT_FALSE(is_same(german, 0)) << "Wien";
  EXPECT_TRUE(is_same(german, 1)) << "Graz has no other name";
  EXPECT_TRUE(is_same(german, 2));
  EXPECT_TRUE(is_same(tile("&label-language=fr"), 0)) << "the table has no such language";
  EXPECT_EQ(json("/catalog")["languages"], Json({"cop", "de"}));
  EXPECT_EQ(json("/values")["tables"][0]["languages"], Json({"cop", "de"}));
  EXPECT_THAT(words(base + "&label-language=german!", 400), HasSubstr("label-language"));

  table.languages = {"nl"};
  try {
    read_named_tables({{"names", table}});
    ADD_FAILURE() << "there is no column name:nl";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("name:nl"));
  }
}

TEST_F(ValuesSiteTest, ColoursByPostedNumbers) {
  const std::string id = id_of("code,score\nC0,1\nC1,5\nC2,9\n");
  const std::string query =
      "values=" + id + "&join=code&color-by=value&breaks=4,8&ramp=Reds&fill=lime";
  const Rgba low = colour(query, 0);
  EXPECT_NE(low, colour(query, 1));
  EXPECT_NE(low, colour(query, 2));
  EXPECT_EQ(colour(query, 3), (Rgba{0, 255, 0, 255}));
  EXPECT_EQ(colour(query + "&no-data-color=blue", 3), (Rgba{0, 0, 255, 255}));
  // The key column has the name of the attribute.
  EXPECT_EQ(colour("values=" + id + "&color-by=value&breaks=4,8&ramp=Reds", 0), low);
}

TEST_F(ValuesSiteTest, ColoursByPostedWordsAndByKeysThatAreNumbers) {
  const std::string id = id_of("[[3, \"yes\"], [\"04\", \"no\"]]");
  const std::string query = "values=" + id + "&join=number&color-by=value&classes=yes:blue,*:red";
  EXPECT_EQ(colour(query, 3), (Rgba{0, 0, 255, 255}));
  EXPECT_EQ(colour(query, 4), (Rgba{255, 0, 0, 255}));
  EXPECT_THAT(words("/tiles/columns/0/0/0.png?values=" + id +
                        "&join=number&color-by=value&breaks=quantile:3&ramp=Reds",
                    400),
              HasSubstr("are text"));
}

TEST_F(ValuesSiteTest, FiltersByValue) {
  const std::string id = id_of("code,score\nC0,1\nC1,5\n");
  EXPECT_EQ(colour("values=" + id + "&filter=value>2&fill=lime", 1), (Rgba{0, 255, 0, 255}));
  EXPECT_EQ(colour("values=" + id + "&filter=value>2&fill=lime", 0).a, 0);
  EXPECT_EQ(colour("values=" + id + "&filter=value+IS+NULL&fill=lime", 2), (Rgba{0, 255, 0, 255}));
}

TEST_F(ValuesSiteTest, WmsKnowsPostedTables) {
  const std::string id = id_of("code,score\nC0,1\nC1,5\n");
  const std::string style =
      "values=" + id + "&color-by=value&breaks=2&ramp=Blues&quality=exact&background=fff";
  const std::string map = "/wms?VERSION=1.1.1&REQUEST=GetMap&LAYERS=columns&STYLES=&SRS=EPSG:4326&";
  const std::string window = "BBOX=-180,-60,180,60&WIDTH=64&HEIGHT=32&FORMAT=image/png&";
  EXPECT_EQ(words(map + window + style, 200),
            words("/map/columns.png?crs=EPSG:4326&bbox=-180,-60,180,60&width=64&height=32&" + style,
                  200));
}

TEST_F(ValuesSiteTest, TellsWhatMatchesAndNamesTheFirstKeysThatDoNot) {
  const auto response =
      post("code,score\nC0,1\nC1,5\nX,9\nY,3\n", "?layer=columns&join=code", "text/csv");
  ASSERT_EQ(response.status, 201);
  const Json told = Json::parse(*response.body);
  EXPECT_EQ(response.header("Location"),
            "http://maps.example:8080/values/" + told["id"].get<std::string>());
  EXPECT_EQ(told["rows"], 4);
  EXPECT_EQ(told["type"], "integer");
  EXPECT_EQ(told["joins"][0]["matched"], 2);
  EXPECT_EQ(told["joins"][0]["unmatched"], 2);
  EXPECT_EQ(told["joins"][0]["unmatched_keys"], Json({"X", "Y"}));
  EXPECT_EQ(told["joins"][0]["features_without_value"], kColumns - 2);
  // The answer stays the same later, and the tiles that it names use it.
  EXPECT_EQ(json("/values/" + told["id"].get<std::string>() + "?layer=columns&join=code"), told);
  std::string tiles = told["joins"][0]["tiles"];
  tiles = tiles.substr(tiles.find('?') + 1);
  EXPECT_NE(colour(tiles, 0), colour(tiles, 1));
}

TEST_F(ValuesSiteTest, TilesThatItNamesHaveAClassForEachOfTheCommonestWords) {
  std::string table = "code,word\n";
  const std::vector<std::string> words = {"'a', b:c", "*", "null", "d&e=f",
                                          "long " + std::string(60, 'x')};
  for (std::size_t i = 0; i < words.size(); ++i) {
    table += fmt::format("C{},\"{}\"\n", i, words[i]);
  }
  const auto response = post(table, "?layer=columns&join=code", "text/csv");
  ASSERT_EQ(response.status, 201);
  std::string tiles = Json::parse(*response.body)["joins"][0]["tiles"];
  tiles = tiles.substr(tiles.find('?') + 1);
  std::set<std::string> colours;
  for (int i = 0; i < 5; ++i) colours.insert(to_hex(colour(tiles, i)));
  EXPECT_EQ(colours.size(), 5u) << "the last has none, and the fill";

  const auto long_ones =
      post("code,word\nC0," + std::string(60, 'x') + "\n", "?layer=columns&join=code", "text/csv");
  tiles = Json::parse(*long_ones.body)["joins"][0]["tiles"];
  EXPECT_EQ(tiles.find("color-by"), std::string::npos) << "nothing that would be refused";
}

TEST_F(ValuesSiteTest, PartsTheSameEverywhereAndTellsTheNumbers) {
  const std::string id = id_of("code,score\nC0,1\nC1,2\nC2,3\nC3,4\nC4,500\nX,1000000\n");
  const std::string query = "values=" + id + "&color-by=value&breaks=quantile:2&ramp=Reds&units=km";
  const Json layer = json("/legend/columns.json?" + query)["layers"][0];
  EXPECT_EQ(layer["classification"]["breaks"], Json({3}));
  EXPECT_EQ(layer["classification"]["max"], 500);
  EXPECT_EQ(layer["classification"]["method"], "quantile:2");
  EXPECT_EQ(layer["classification"]["join"]["unmatched_keys"], Json({"X"}));
  EXPECT_EQ(layer["values_title"], "score");
  EXPECT_EQ(layer["entries"].size(), 3u);
  EXPECT_EQ(layer["entries"][0]["label"], "1 to 3\u00a0km");
  EXPECT_EQ(layer["entries"][1]["label"], "3 to 500\u00a0km");
  EXPECT_EQ(layer["entries"][1]["from"], 3);
  EXPECT_EQ(layer["entries"][2]["label"], "no data");
  EXPECT_EQ(layer["histogram"]["counts"][0], 4);
  EXPECT_EQ(json("/tiles/columns.json?" + query)["classification"]["columns"]["breaks"], Json({3}));
  // A tile that shows only C0 and C1 has the same break as one that shows all.
  const auto part =
      decode_png(*sample_.get("/tiles/columns/1/0/0.png?quality=exact&" + query).body);
  EXPECT_EQ(part.at(32, 200), colour(query, 0));
  EXPECT_EQ(part.at(32, 200), part.at(96, 200));
  EXPECT_EQ(part.at(160, 200), colour(query, 2));
}

TEST_F(ValuesSiteTest, PartsAttributesByTheSameRules) {
  const Json layer = json(
      "/legend/columns.json?color-by=number&breaks=jenks:4&ramp=Reds&label-format=.1f")["layers"]
                                                                                       [0];
  EXPECT_EQ(layer["classification"]["classes"], 4);
  EXPECT_EQ(layer["classification"]["count"], kColumns);
  EXPECT_EQ(layer["entries"][0]["label"], "0.0 to 2.0");
  EXPECT_FALSE(layer["classification"].contains("join"));
}

TEST_F(ValuesSiteTest, HasFewerClassesWhereThereAreFewerValuesAndSaysSo) {
  std::string query =
      "values=" + id_of("code,v\nC0,7\nC1,7\n") + "&color-by=value&breaks=quantile:5&ramp=Reds";
  Json layer = json("/legend/columns.json?" + query)["layers"][0];
  EXPECT_EQ(layer["classification"]["classes"], 1);
  EXPECT_THAT(layer["classification"]["note"].get<std::string>(),
              HasSubstr("1 classes instead of 5"));
  EXPECT_EQ(layer["entries"].size(), 2u);
  EXPECT_EQ(layer["entries"][0]["label"], "7");
  EXPECT_EQ(colour(query, 0), colour(query, 1));
  EXPECT_NE(colour(query, 0), colour(query, 2));
  query = "values=" + id_of("code,v\nC0,\nX,7\n") + "&color-by=value&breaks=quantile:5&ramp=Reds";
  layer = json("/legend/columns.json?" + query)["layers"][0];
  EXPECT_EQ(layer["entries"].size(), 1u);
  EXPECT_EQ(layer["entries"][0]["label"], "no data");
  EXPECT_EQ(colour(query, 0), colour(query, 2));
}

TEST_F(ValuesSiteTest, LabelsTellClassesApartHoweverSmallTheNumbersAre) {
  const std::string id = id_of("code,v\nC0,1e-12\nC1,2.5e-12\nC2,8e-12\n");
  const Json layer = json("/legend/columns.json?values=" + id +
                          "&color-by=value&breaks=quantile:3&ramp=Reds")["layers"][0];
  EXPECT_EQ(layer["entries"][0]["label"], "1e-12 to 2.5e-12");
  EXPECT_EQ(layer["entries"][1]["label"], "2.5e-12 to 8e-12");
  EXPECT_EQ(layer["entries"][2]["label"], "8e-12");
}

TEST_F(ValuesSiteTest, HasTagsOfWhatIsSeen) {
  const std::string rest = "&color-by=value&breaks=4&ramp=Reds";
  const auto tag = [&](const std::string& table) {
    return std::string(
        sample_.get("/tiles/columns/0/0/0.png?values=" + id_of(table) + rest).header("ETag"));
  };
  const std::string first = tag("code,v\nC0,1\nC1,5\n");
  EXPECT_EQ(tag("code,v\nC0,2\nC1,6\n"), first);  // the same picture
  EXPECT_NE(tag("code,v\nC0,5\nC1,1\n"), first);
}

TEST_F(ValuesSiteTest, ReadsTablesOfTheConfigurationAgain) {
  const std::string tile = "/tiles/columns/0/0/0.png?style=crowd";
  const auto before = sample_.get(tile);
  ASSERT_EQ(before.status, 200);
  EXPECT_EQ(colour("style=crowd", 0), colour("style=crowd", 1));
  EXPECT_EQ(colour("style=crowd", 4), (Rgba{255, 0, 0, 255}));
  EXPECT_EQ(json("/values")["tables"][0]["title"], "People");
  EXPECT_THAT(json("/tiles/columns.json?style=crowd")["attribution"].get<std::string>(),
              HasSubstr("counted by hand"));
  EXPECT_THAT(json("/ogc/collections/columns/map/tiles/WebMercatorQuad?style=crowd")["attribution"]
                  .get<std::string>(),
              HasSubstr("counted by hand"));
  EXPECT_FALSE(json("/ogc/collections/columns/map/tiles/WebMercatorQuad").contains("attribution"));
  EXPECT_EQ(json("/legend/columns.json?style=crowd")["layers"][0]["values_title"], "People");
  const std::string generation = json("/catalog")["generation"];
  serve("code,people\nC0,40\nC1,20\nC2,30\nC3,10\nC4,20\n");
  EXPECT_NE(sample_.get(tile).header("ETag"), before.header("ETag"));
  EXPECT_NE(colour("style=crowd", 0), colour("style=crowd", 1));
  EXPECT_NE(colour("style=crowd", 4), (Rgba{255, 0, 0, 255}));
  EXPECT_NE(json("/catalog")["generation"], generation);
}

TEST_F(ValuesSiteTest, KeepsTitleAndAttributionWhenTheLayerIsNotReadAgain) {
  ValueTableConfig table;
  table.file = folder_.write("people.csv", "code,people\nC0,10\nC1,20\n");
  table.title = "People";
  table.attribution = "counted by hand";
  const auto layers = layers_of_files({folder_.write("columns.geojson", columns())});
  const std::string query = "?values=people&color-by=value&breaks=15&ramp=Reds";
  for (int load = 0; load < 2; ++load) {
    sample_.data().set(Dataset::load(layers, sample_.data().get().get(), nullptr,
                                     read_named_tables({{"people", table}})));
    EXPECT_EQ(json("/legend/columns.json" + query)["layers"][0]["values_title"], "People") << load;
    EXPECT_THAT(json("/tiles/columns.json" + query)["attribution"].get<std::string>(),
                HasSubstr("counted by hand"))
        << load;
  }
}

TEST_F(ValuesSiteTest, NamesTheTableThatIsAskedForEvenIfAnotherOneIsTheSame) {
  ValueTableConfig people;
  people.file = folder_.write("people.csv", "code,people\nC0,10\nC1,20\n");
  people.title = "People";
  ValueTableConfig residents = people;
  residents.title = "Residents";
  ValueTableConfig untitled = people;
  untitled.title.clear();
  const auto layers = layers_of_files({folder_.write("columns.geojson", columns())});
  sample_.data().set(Dataset::load(
      layers, nullptr, nullptr,
      read_named_tables({{"people", people}, {"residents", residents}, {"untitled", untitled}})));
  const auto title = [&](const std::string& table) -> std::string {
    return json("/legend/columns.json?color-by=value&breaks=15&ramp=Reds&values=" +
                table)["layers"][0]["values_title"];
  };
  EXPECT_EQ(title("people"), "People");
  EXPECT_EQ(title("residents"), "Residents");
  EXPECT_EQ(title("untitled"), "people");
}

class SmallValuesSiteTest : public ValuesSiteTest {
 protected:
  SmallValuesSiteTest() : ValuesSiteTest(20'000) {}
};

TEST_F(SmallValuesSiteTest, GivesUpTheTableThatWasNotAskedForLongest) {
  std::vector<std::string> ids;
  for (int i = 0; i < 60; ++i) ids.push_back(id_of("code,v\nC0," + std::to_string(i) + "\n"));
  const std::string rest = "&color-by=value&breaks=4&ramp=Reds";
  EXPECT_THAT(words("/tiles/columns/0/0/0.png?values=" + ids[0] + rest, 404),
              HasSubstr("post it again"));
  EXPECT_THAT(words("/values/" + ids[0], 404), HasSubstr("post it again"));
  EXPECT_EQ(sample_.get("/tiles/columns/0/0/0.png?values=" + ids[59] + rest).status, 200);
  EXPECT_EQ(id_of("code,v\nC0,0\n"), ids[0]);
  EXPECT_EQ(sample_.get("/tiles/columns/0/0/0.png?values=" + ids[0] + rest).status, 200);
}

TEST_F(SmallValuesSiteTest, RefusesMoreThanOneAddressMayPost) {
  const std::string table = "k,v\n" + std::string(200, 'a') + ",1\n";
  int refused = 0;
  for (int i = 0; i < 100; ++i)
    refused += post(table + std::to_string(i) + ",1\n").status == 429 ? 1 : 0;
  EXPECT_GT(refused, 20);
  EXPECT_LT(refused, 80);
}

TEST_F(ValuesSiteTest, RefusesHostileTables) {
  const std::string many = [] {
    std::string rows = "k,v\n";
    for (int i = 0; i < 101; ++i) rows += std::to_string(i) + ",1\n";
    return rows;
  }();
  const struct {
    std::string body;
    std::string content_type;
    int status;
  } cases[] = {
      {"", "", 400},
      {std::string(1000, '\0'), "text/csv", 400},
      {"k,v\na,1\na,2\n", "", 400},
      {"k,v\na,inf\n", "", 400},
      {"k,v\na,\xff\n", "", 400},
      {"\xff\xfek\0,\0v\0", "", 400},
      {std::string(100'000, ','), "", 400},
      {std::string(100'000, '['), "", 400},
      {std::string(100'000, '{'), "application/json", 400},
      {"{\"a\":", "application/json", 400},
      {"k,v\n\"a,1\n", "", 400},
      {"k,v\n" + std::string(10'000, 'a') + ",1\n", "", 400},
      {many, "", 413},
      {"k,v\na,1\n", "image/png", 415},
      {"k,v\na,1\n", "multipart/form-data; boundary=x", 415},
      {"k,v\na,1\n", "text/csv; charset=latin1", 415},
  };
  for (const auto& each : cases) {
    const auto response = post(each.body, {}, each.content_type);
    EXPECT_EQ(response.status, each.status) << each.body.substr(0, 40);
    EXPECT_NE(response.problem, nullptr);
  }
  EXPECT_EQ(post("k,v\na,1\n", "?nosuch=1").status, 400);
  EXPECT_EQ(post("k,v\na,1\n", "?key=k&key=v").status, 400);
  EXPECT_EQ(post("k,v\na,1\n", "?layer=nosuch").status, 404);
  EXPECT_EQ(post("k,v\na,1\n", "?layer=columns&join=nosuch").status, 400);
  EXPECT_EQ(post("k,v\na,1\n", "?key=nosuch").status, 400);
}

TEST_F(ValuesSiteTest, RefusesStylesThatDoNotFit) {
  const std::string id = id_of("key,v\nC0,1\n");
  const std::string tile = "/tiles/columns/0/0/0.png?";
  EXPECT_THAT(words(tile + "values=" + id, 400), HasSubstr("set join to"));
  EXPECT_THAT(words(tile + "values=" + id + "&join=nosuch", 400), HasSubstr("code, number"));
  EXPECT_THAT(words(tile + "join=code", 400), HasSubstr("values"));
  EXPECT_THAT(words(tile + "values=nosuch&join=code", 404), HasSubstr("people"));
  EXPECT_THAT(words(tile + "color-by=value&breaks=1&ramp=Reds", 400), HasSubstr("no attribute"));
  EXPECT_THAT(words(tile + "color-by=number&breaks=quantile:99&ramp=Reds", 400),
              HasSubstr("2 to 32"));
  EXPECT_THAT(words(tile + "color-by=code&breaks=quantile:3&ramp=Reds", 400), HasSubstr("text"));
  EXPECT_THAT(words(tile + "label-format=x", 400), HasSubstr("label-format"));
}

TEST_F(ValuesSiteTest, LetsPagesOfOtherOriginsPost) {
  const auto response = sample_.handle({"OPTIONS", "/values", "maps.example:8080", {}, {}});
  EXPECT_EQ(response.status, 204);
  EXPECT_THAT(std::string(response.header("Access-Control-Allow-Methods")), HasSubstr("POST"));
  EXPECT_EQ(post("code,v\nC0,1\n").header("Access-Control-Allow-Origin"), "*");
  EXPECT_EQ(sample_.handle({"POST", "/values/abc", "maps.example:8080", {}, {}}).status, 405);
}

TEST(ValuesSiteLimitsTest, TakesNoTablesWhereNoneAreKept) {
  SiteOptions options;
  options.posted_values = 0;
  testing::SampleSite sample(true, {}, options);
  EXPECT_EQ(sample.handle({"POST", "/values", "maps.example:8080", {}, "k,v\na,1\n"}).status, 403);
}

}  // namespace
}  // namespace trapeze
