#include "server/documents/wmts.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "core/layer/layer_builder.h"
#include "server/base/xml_text.h"
#include "server/config/load_config.h"
#include "server/tiles/read_tile_matrix_set.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using testing::changed;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kTile =
    "/wmts?SERVICE=WMTS&REQUEST=GetTile&VERSION=1.0.0&LAYER=rings&STYLE=default"
    "&FORMAT=image/png&TILEMATRIXSET=WebMercatorQuad&TILEMATRIX=3&TILEROW=2&TILECOL=5";

const std::string kTileInfo =
    changed(kTile, "GetTile", "GetFeatureInfo") + "&INFOFORMAT=application/geo%2Bjson&I=128&J=1";

class WmtsTest : public ::testing::Test {
 protected:
  testing::SampleSite sample_;
};

TEST_F(WmtsTest, CapabilitiesNameLayersAndTheirTiles) {
  const auto response = sample_.get("/wmts.xml");
  ASSERT_EQ(response.status, 200);
  EXPECT_EQ(response.header("Content-Type"), "application/xml");
  for (const char* part :
       {"<ows:Identifier>rings</ows:Identifier>", "<ows:Title>Rings</ows:Title>",
        "<ows:Title>default</ows:Title>\n        <ows:Identifier>default</ows:Identifier>",
        "resourceType=\"tile\"", "resourceType=\"FeatureInfo\"",
        "http://maps.example:8080/wmts/rings/{Style}/{TileMatrixSet}/{TileMatrix}/{TileRow}/"
        "{TileCol}.png",
        "<InfoFormat>application/geo+json</InfoFormat>", "<ows:Operation name=\"GetFeatureInfo\">",
        "http://maps.example:8080/legend/west.png", "<ows:LowerCorner>-90 ",
        "<ScaleDenominator>559082264.028", "<MatrixWidth>16777216</MatrixWidth>",
        "<ServiceMetadataURL xlink:href=\"http://maps.example:8080/wmts.xml\"/>"}) {
    EXPECT_THAT(*response.body, HasSubstr(part));
  }
  for (const char* target :
       {"/wmts?service=wmts&request=GetCapabilities", "/wmts/1.0.0/WMTSCapabilities.xml",
        "/wmts?SERVICE=WMTS&REQUEST=GetCapabilities&AcceptVersions=2.0.0,1.0.0&Sections=All"}) {
    EXPECT_EQ(*sample_.get(target).body, *response.body) << target;
  }
}

TEST_F(WmtsTest, WhatTheConfigurationSaysIsEscaped) {
  auto layers = layers_of_files({testing::fixture("rings.geojson")});
  layers[0].title = "<Ä & \"B\">";
  layers[0].description = "bad \x01 \xff bytes";
  sample_.data().set(Dataset::load(layers));
  const std::string xml = *sample_.get("/wmts.xml").body;
  EXPECT_THAT(xml, HasSubstr("<ows:Title>&lt;Ä &amp; &quot;B&quot;&gt;</ows:Title>"));
  EXPECT_THAT(xml, HasSubstr("bad \xef\xbf\xbd \xef\xbf\xbd bytes"));
}

TEST_F(WmtsTest, SectionsAreThoseThatAreAskedFor) {
  const std::string target = "/wmts?service=WMTS&request=GetCapabilities&sections=";
  const auto has = [&](const std::string& sections, const char* part) {
    const auto response = sample_.get(target + sections);
    EXPECT_EQ(response.status, 200) << *response.body;
    return response.body->find(part) != std::string::npos;
  };
  EXPECT_TRUE(has("Contents", "<Contents>"));
  EXPECT_FALSE(has("Contents", "<ows:OperationsMetadata>"));
  EXPECT_FALSE(has("Contents", "<ows:ServiceIdentification>"));
  EXPECT_TRUE(has("OperationsMetadata,serviceidentification", "<ows:OperationsMetadata>"));
  EXPECT_TRUE(has("OperationsMetadata,serviceidentification", "<ows:ServiceIdentification>"));
  EXPECT_FALSE(has("OperationsMetadata,serviceidentification", "<Contents>"));
  EXPECT_TRUE(has("All", "<Contents>"));
  EXPECT_FALSE(has("Themes", "<Contents>"));
}

TEST_F(WmtsTest, TilesAreTheSameByKeysAndValuesAndByAddresses) {
  const std::string tile = *sample_.get("/tiles/rings/3/5/2.png").body;
  EXPECT_EQ(*sample_.get(kTile).body, tile);
  EXPECT_EQ(*sample_.get("/wmts/rings/default/WebMercatorQuad/3/2/5.png").body, tile);
  const std::string lime = *sample_.get("/tiles/rings/3/5/2.png?fill=lime").body;
  EXPECT_EQ(*sample_.get(kTile + "&fill=lime").body, lime);
  EXPECT_EQ(*sample_.get("/wmts/rings/default/WebMercatorQuad/3/2/5.png?fill=lime").body, lime);
}

TEST_F(WmtsTest, KeysMayBeWrittenInAnyCaseAndTheStyleMayBeEmpty) {
  const std::string body = *sample_.get(kTile).body;
  for (const char* style : {"STYLE=", "style=", "Style=default", "style=default"}) {
    const auto response = sample_.get(
        std::string("/wmts?Request=GetTile&service=wmts&Version=1.0.0&layer=rings&TileMatrix=3"
                    "&tilerow=2&tilecol=5&FORMAT=image/png&tileMatrixSet=WebMercatorQuad&") +
        style);
    ASSERT_EQ(response.status, 200) << style << *response.body;
    EXPECT_EQ(*response.body, body) << style;
  }
}

TEST_F(WmtsTest, UnknownKeysArePassedOverUnlessAStyleIsMeant) {
  const std::string body = *sample_.get(kTile).body;
  for (const char* pair :
       {"&TIME=2020-01-01", "&elevation=3", "&token=abc", "&dim_x=%26", "&_=7"}) {
    const auto response = sample_.get(kTile + pair);
    ASSERT_EQ(response.status, 200) << pair << *response.body;
    EXPECT_EQ(*response.body, body) << pair;
  }
  for (const char* pair : {"&FILL=red", "&fil=red", "&rings.fil=red", "&fill=no"}) {
    EXPECT_EQ(sample_.get(kTile + pair).status, 400) << pair;
  }
}

TEST_F(WmtsTest, FeaturesUnderAPixelAreTold) {
  // At zoom 0, the rings cover pixels 64 to 192 except the hole from 96 to 160, with an island from
  // 112 to 144.
  const auto at = [](int i, int j) {
    return "/wmts/rings/default/WebMercatorQuad/0/0/0/" + std::to_string(j) + "/" +
           std::to_string(i) + ".json";
  };
  const auto count = [&](int i, int j) {
    const auto response = sample_.get(at(i, j) + "?simplify=0");
    EXPECT_EQ(response.status, 200) << *response.body;
    return nlohmann::json::parse(*response.body)["numberMatched"].get<int>();
  };
  for (const int edge : {64, 112, 160}) {
    EXPECT_EQ(count(edge - 1, 128), 0) << edge;
    EXPECT_EQ(count(edge, 128), 1) << edge;
    EXPECT_EQ(count(128, edge - 1), 0) << edge;
    EXPECT_EQ(count(128, edge), 1) << edge;
  }
  EXPECT_EQ(count(0, 0), 0);
  EXPECT_EQ(count(255, 255), 0);
  const auto response = sample_.get(at(70, 80));
  EXPECT_EQ(response.header("Content-Type"), "application/geo+json");
  const auto json = nlohmann::json::parse(*response.body);
  EXPECT_EQ(json["features"][0]["id"], 7);
  EXPECT_EQ(json["features"][0]["properties"]["rank"], 1);
}

TEST_F(WmtsTest, FeaturesAreTheSameByKeysAndValuesAndInEveryFormat) {
  const std::string path = "/wmts/rings/default/WebMercatorQuad/3/2/5/1/128";
  const std::string json = *sample_.get(path + ".json").body;
  EXPECT_EQ(nlohmann::json::parse(json)["numberMatched"], 1);
  const std::string name = "a square with a hole, and an island in the hole";
  for (const auto& [format, type] : std::vector<std::pair<std::string, std::string>>{
           {"application/geo%2Bjson", "application/geo+json"},
           {"application/json", "application/json"}}) {
    const auto response = sample_.get(changed(kTileInfo, "application/geo%2Bjson", format));
    EXPECT_EQ(response.header("Content-Type"), type);
    EXPECT_EQ(*response.body, json);
  }
  const auto text = sample_.get(changed(kTileInfo, "application/geo%2Bjson", "text/plain"));
  EXPECT_EQ(text.header("Content-Type"), "text/plain; charset=utf-8");
  EXPECT_EQ(text.body->substr(0, name.size() + 1), name + "\n");
  EXPECT_THAT(*text.body, HasSubstr("  rank = 1\n"));
  EXPECT_EQ(*sample_.get(path + ".txt").body, *text.body);
  const auto html = sample_.get(path + ".html");
  EXPECT_EQ(html.header("Content-Type"), "text/html; charset=utf-8");
  EXPECT_THAT(*html.body, HasSubstr("<caption>" + name + "</caption>"));
  EXPECT_THAT(*html.body, HasSubstr("<th scope=\"row\">rank</th><td>1</td>"));
  EXPECT_EQ(*sample_.get("/wmts/rings/default/WebMercatorQuad/0/0/0/0/0.txt").body,
            "There is nothing here.\n");
}

TEST_F(WmtsTest, WhatIsWrongIsAnExceptionWithItsCodeAndItsParameter) {
  const std::string info = "/wmts/rings/default/WebMercatorQuad/3/2/5/";
  const std::string capabilities = "/wmts?service=WMTS&request=GetCapabilities";
  struct Wrong {
    std::string target;
    int status;
    std::string code;
    std::string locator;
  };
  const auto without = [](const std::string& pair) { return changed(kTile, pair, ""); };
  const std::vector<Wrong> wrongs = {
      {"/wmts", 400, "MissingParameterValue", "Service"},
      {"/wmts?service=WMTS", 400, "MissingParameterValue", "Request"},
      {"/wmts?request=GetCapabilities", 400, "MissingParameterValue", "Service"},
      {"/wmts?service=WMS&request=GetCapabilities", 400, "InvalidParameterValue", "Service"},
      {"/wmts?service=WMTS&request=GetMap", 400, "InvalidParameterValue", "Request"},
      {capabilities + "&REQUEST=GetTile", 400, "InvalidParameterValue", "Request"},
      {capabilities + "&AcceptVersions=0.9,2.0.0", 400, "VersionNegotiationFailed", ""},
      {capabilities + "&Sections=", 400, "MissingParameterValue", "Sections"},
      {capabilities + "&Sections=Contents,Nothing", 400, "InvalidParameterValue", "Sections"},
      {without("&VERSION=1.0.0"), 400, "MissingParameterValue", "Version"},
      {without("&LAYER=rings"), 400, "MissingParameterValue", "Layer"},
      {without("&STYLE=default"), 400, "MissingParameterValue", "Style"},
      {without("&FORMAT=image/png"), 400, "MissingParameterValue", "Format"},
      {without("&TILEMATRIXSET=WebMercatorQuad"), 400, "MissingParameterValue", "TileMatrixSet"},
      {without("&TILEMATRIX=3"), 400, "MissingParameterValue", "TileMatrix"},
      {without("&TILEROW=2"), 400, "MissingParameterValue", "TileRow"},
      {without("&TILECOL=5"), 400, "MissingParameterValue", "TileCol"},
      {changed(kTile, "1.0.0", "2.0.0"), 400, "InvalidParameterValue", "Version"},
      {changed(kTile, "=rings", "=nosuch"), 400, "InvalidParameterValue", "Layer"},
      {changed(kTile, "=rings", "="), 400, "MissingParameterValue", "Layer"},
      {changed(kTile, "=rings", "=a%20b"), 400, "InvalidParameterValue", "Layer"},
      {changed(kTile, "default", "nosuch"), 400, "InvalidParameterValue", "Style"},
      {changed(kTile, "image/png", "image/jpeg"), 400, "InvalidParameterValue", "Format"},
      {changed(kTile, "WebMercatorQuad", "GlobalCRS84Scale"), 400, "InvalidParameterValue",
       "TileMatrixSet"},
      {changed(kTile, "MATRIX=3", "MATRIX=25"), 400, "InvalidParameterValue", "TileMatrix"},
      {changed(kTile, "TILEROW=2", "TILEROW=8"), 400, "TileOutOfRange", "TileRow"},
      {changed(kTile, "TILEROW=2", "TILEROW=-1"), 400, "TileOutOfRange", "TileRow"},
      {changed(kTile, "TILEROW=2", "TILEROW=99999999999999999999"), 400, "TileOutOfRange",
       "TileRow"},
      {changed(kTile, "TILEROW=2", "TILEROW=x"), 400, "InvalidParameterValue", "TileRow"},
      {changed(kTile, "TILECOL=5", "TILECOL=8"), 400, "TileOutOfRange", "TileCol"},
      {kTile + "&fill=no", 400, "InvalidParameterValue", "fill"},
      {kTile + "&layer=west", 400, "InvalidParameterValue", "Layer"},
      {"/wmts/rings/default/WebMercatorQuad/3/8/5.png", 404, "TileOutOfRange", "TileRow"},
      {"/wmts/west/default/WebMercatorQuad/6/0/0.png", 404, "TileOutOfRange", "TileMatrix"},
      {"/wmts/rings/default/WebMercatorQuad/5/16/30.png", 404, "TileOutOfRange", "TileCol"},
      {"/wmts/nosuch/default/WebMercatorQuad/3/2/5.png", 404, "InvalidParameterValue", "Layer"},
      {"/wmts/rings/nosuch/WebMercatorQuad/3/2/5.png", 404, "InvalidParameterValue", "Style"},
      {"/wmts/rings/default/nosuch/3/2/5.png", 404, "InvalidParameterValue", "TileMatrixSet"},
      {"/wmts/rings/default/WebMercatorQuad/3/2/x.png", 400, "InvalidParameterValue", "TileCol"},
      {"/wmts/rings/default/WebMercatorQuad/3/2/5.png?fill=no", 400, "InvalidParameterValue",
       "fill"},
      {"/wmts/rings/default/WebMercatorQuad/3/2/5.gif", 404, "NoApplicableCode", ""},
      {info + "1/256.json", 400, "PointIJOutOfRange", "I"},
      {info + "-1/0.json", 400, "PointIJOutOfRange", "J"},
      {info + "1/x.json", 400, "InvalidParameterValue", "I"},
      {info + "1/1.gml", 404, "NoApplicableCode", ""},
      {info + "1/1", 404, "NoApplicableCode", ""},
      {"/wmts.xml/x", 404, "NoApplicableCode", ""},
      {"/wmts/x", 404, "NoApplicableCode", ""},
      {"/wmts?%", 400, "NoApplicableCode", ""}};
  for (const Wrong& wrong : wrongs) {
    const auto response = sample_.get(wrong.target);
    EXPECT_EQ(response.status, wrong.status) << wrong.target;
    EXPECT_EQ(response.header("Content-Type"), "application/xml") << wrong.target;
    EXPECT_EQ(response.header("Cache-Control"), "no-store") << wrong.target;
    const std::string locator = wrong.locator.empty() ? "" : " locator=\"" + wrong.locator + "\"";
    EXPECT_THAT(*response.body,
                HasSubstr("<ows:Exception exceptionCode=\"" + wrong.code + "\"" + locator + ">"))
        << wrong.target;
  }
}

TEST_F(WmtsTest, TilesBesideTheLayerShowWhatReachesIntoThem) {
  const std::string beside = "/wmts/rings/default/WebMercatorQuad/3/3/0.png";
  EXPECT_EQ(sample_.get(beside).status, 404) << "256 pixels west of the layer";
  for (const char* style : {"?label=name&label-overhang=300", "?label=name&label-overhang=260"}) {
    EXPECT_EQ(sample_.get(beside + style).status, 200) << style;
  }
  // "west" ends at the antimeridian: corners of its outline are at the other side, too.
  const std::string style = "?stroke=red&stroke-width=20";
  const auto around = sample_.get("/wmts/west/default/WebMercatorQuad/3/0/7.png" + style);
  EXPECT_EQ(around.status, 200);
  EXPECT_EQ(*around.body, *sample_.get("/tiles/west/3/7/0.png" + style).body);
}

TEST_F(WmtsTest, PixelsAndFormatsOfFeaturesAreChecked) {
  const auto exception = [this](const std::string& target) {
    const auto response = sample_.get(target);
    EXPECT_EQ(response.status, 400) << target;
    const std::string begin = "exceptionCode=\"";
    const std::size_t at = response.body->find(begin) + begin.size();
    return response.body->substr(at, response.body->find('>', at) - at);
  };
  const std::string& info = kTileInfo;
  EXPECT_EQ(sample_.get(info).status, 200);
  EXPECT_EQ(exception(changed(info, "&I=128", "")), "MissingParameterValue\" locator=\"I\"");
  EXPECT_EQ(exception(changed(info, "&J=1", "")), "MissingParameterValue\" locator=\"J\"");
  EXPECT_EQ(exception(changed(info, "&INFOFORMAT=application/geo%2Bjson", "")),
            "MissingParameterValue\" locator=\"InfoFormat\"");
  EXPECT_EQ(exception(changed(info, "geo%2Bjson", "gml")),
            "InvalidParameterValue\" locator=\"InfoFormat\"");
  EXPECT_EQ(exception(changed(info, "I=128", "I=256")), "PointIJOutOfRange\" locator=\"I\"");
  EXPECT_EQ(exception(changed(info, "J=1", "J=-1")), "PointIJOutOfRange\" locator=\"J\"");
  EXPECT_EQ(exception(changed(info, "J=1", "J=1.5")), "InvalidParameterValue\" locator=\"J\"");
  EXPECT_EQ(exception(changed(info, "TILEROW=2", "TILEROW=8")),
            "TileOutOfRange\" locator=\"TileRow\"");
}

TEST_F(WmtsTest, WhatIsWrongIsEscapedAndCut) {
  const std::string body =
      *sample_.get(kTile + "&%22%3E%3Cscript%3E" + std::string(500, 'x') + ".fill=red").body;
  EXPECT_THAT(body, Not(HasSubstr("<script>")));
  EXPECT_THAT(body, HasSubstr("&lt;script&gt;"));
  EXPECT_LT(body.size(), 1800u) << "the locator is cut, so that the name stands there twice only";
}

TEST(WmtsLoadingTest, IsToldInItsOwnWords) {
  testing::SampleSite loading(/*is_loaded=*/false);
  const auto response = loading.get("/wmts.xml");
  EXPECT_EQ(response.status, 503);
  EXPECT_EQ(response.header("Retry-After"), "1");
  EXPECT_THAT(*response.body, HasSubstr("exceptionCode=\"NoApplicableCode\">"));
}

TEST(WmtsSetsTest, NoNameOfASetBecomesMarkup) {
  TileMatrixSets sets = TileMatrixSets::built_in();
  sets.add(parse_tile_matrix_set(R"({"id": "own", "title": "<own>", "crs": "EPSG:3857",
    "wellKnownScaleSet": "http://maps.example/<own>&", "tileMatrices": [{"id": "<0>&",
    "scaleDenominator": 559082264.028717, "pointOfOrigin": [-20037508.34, 20037508.34],
    "tileWidth": 256, "tileHeight": 256, "matrixWidth": 1, "matrixHeight": 1}]})"));
  SiteOptions options;
  options.sets = std::make_shared<const TileMatrixSets>(std::move(sets));
  testing::SampleSite sample(true, {}, options);
  const std::string xml = *sample.get("/wmts.xml").body;
  for (const char* markup : {"<0>", "<own>", "&<", ">&<"}) EXPECT_THAT(xml, Not(HasSubstr(markup)));
  EXPECT_THAT(xml, HasSubstr("<TileMatrix>&lt;0&gt;&amp;</TileMatrix>"));
  EXPECT_THAT(xml, HasSubstr(":&lt;own&gt;&amp;</WellKnownScaleSet>"));
}

TEST(WmtsAttributesTest, NoAttributeBecomesMarkup) {
  FeatureTable features({{"<i>", FieldType::text}, {"name", FieldType::text}});
  features.append(1, std::vector<Value>{std::string_view("<script>alert(1)</script>"),
                                        std::string_view("\"<b>&'")});
  std::vector<LayerBuilder> builders(1);
  Rings rings;
  rings.add(std::vector<Point>{
      {kGridMin, kGridMin}, {kGridMax, kGridMin}, {kGridMax, kGridMax}, {kGridMin, kGridMax}});
  builders.front().add(0, rings);
  ServedLayer served;
  served.config.name = "evil";
  served.layer = LayerBuilder::join(builders, std::move(features));
  std::vector<ServedLayer> layers;
  layers.push_back(std::move(served));
  testing::SampleSite sample;
  sample.data().set(std::make_shared<const Dataset>(std::move(layers)));
  const auto html = sample.get("/wmts/evil/default/WebMercatorQuad/0/0/0/9/9.html");
  ASSERT_EQ(html.status, 200);
  for (const char* markup : {"<script", "<i>", "<b>"}) {
    EXPECT_THAT(*html.body, Not(HasSubstr(markup)));
  }
  EXPECT_THAT(*html.body, HasSubstr("&lt;script&gt;alert(1)&lt;/script&gt;"));
}

TEST(XmlTextTest, NothingGetsOutOfItsPlace) {
  EXPECT_EQ(xml_escape("a<b>&\"c'"), "a&lt;b&gt;&amp;&quot;c&#39;");
  EXPECT_EQ(xml_escape("Zürich \xe4\xb8\xad \xf0\x9f\x97\xba"),
            "Zürich \xe4\xb8\xad \xf0\x9f\x97\xba");
}

TEST(XmlTextTest, WhatXmlDoesNotAllowIsReplaced) {
  const std::string replacement = "\xef\xbf\xbd";
  for (const std::string text : {"\x01", "\x1f", "\xff", "\x80", "\xc3"}) {
    EXPECT_EQ(xml_escape(text), replacement);
  }
  EXPECT_EQ(xml_escape(std::string_view("\0", 1)), replacement);
  EXPECT_EQ(xml_escape("\xc0\xaf"), replacement + replacement) << "an overlong slash";
  EXPECT_EQ(xml_escape("\xe0\x80\xbc").find('<'), std::string::npos) << "an overlong bracket";
  EXPECT_THAT(xml_escape("\xed\xa0\x80"), Not(HasSubstr("\xed"))) << "a surrogate";
  EXPECT_EQ(xml_escape("\xef\xbf\xbf").substr(0, 3), replacement);
  EXPECT_EQ(xml_escape("\xe4\xb8"), replacement + replacement) << "cut off";
}

}  // namespace
}  // namespace trapeze
