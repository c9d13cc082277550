#include "server/documents/wmts.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "server/base/xml_text.h"
#include "server/config/load_config.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kTile =
    "/wmts?SERVICE=WMTS&REQUEST=GetTile&VERSION=1.0.0&LAYER=rings&STYLE=default"
    "&FORMAT=image/png&TILEMATRIXSET=WebMercatorQuad&TILEMATRIX=3&TILEROW=2&TILECOL=5";

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
        "http://maps.example:8080/tiles/rings/s/{Style}/{TileMatrix}/{TileCol}/{TileRow}.png",
        "http://maps.example:8080/legend/west.png", "<ows:LowerCorner>-90 ",
        "<ScaleDenominator>559082264.028", "<MatrixWidth>16777216</MatrixWidth>",
        "<ServiceMetadataURL xlink:href=\"http://maps.example:8080/wmts.xml\"/>"}) {
    EXPECT_THAT(*response.body, HasSubstr(part));
  }
  EXPECT_EQ(*sample_.get("/wmts?service=wmts&request=GetCapabilities").body, *response.body);
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

TEST_F(WmtsTest, TilesAreTheSameByKeysAndValues) {
  EXPECT_EQ(*sample_.get(kTile).body, *sample_.get("/tiles/rings/3/5/2.png").body);
  EXPECT_EQ(*sample_
                 .get("/wmts?request=gettile&layer=rings&tilematrix=3&tilerow=2&tilecol=5"
                      "&fill=lime")
                 .body,
            *sample_.get("/tiles/rings/3/5/2.png?fill=lime").body);
}

TEST_F(WmtsTest, KeysMayBeWrittenInAnyCaseAndTheStyleMayBeEmpty) {
  const std::string body = *sample_.get(kTile).body;
  for (const char* style : {"STYLE=", "style=", "Style=default", "style=default"}) {
    const auto response = sample_.get(
        std::string("/wmts?Request=GetTile&layer=rings&TileMatrix=3&tilerow=2&tilecol=5&") + style);
    ASSERT_EQ(response.status, 200) << style << *response.body;
    EXPECT_EQ(*response.body, body) << style;
  }
}

TEST_F(WmtsTest, WhatIsWrongIsSaid) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string target = kTile;
    return target.replace(target.find(from), from.size(), to);
  };
  const std::vector<std::pair<std::string, int>> wrong = {
      {"/wmts", 400},
      {"/wmts?request=GetFeatureInfo", 400},
      {"/wmts?service=WMS&request=GetCapabilities", 400},
      {with("=rings", "=nosuch"), 404},
      {with("=rings", "="), 400},
      {with("default", "nosuch"), 400},
      {with("image/png", "image/jpeg"), 400},
      {with("WebMercatorQuad", "WorldCRS84Quad"), 400},
      {with("TILEROW=2", "TILEROW=8"), 404},
      {with("TILEROW=2", "TILEROW=x"), 400},
      {with("1.0.0", "2.0.0"), 400},
      {kTile + "&fill=no", 400},
      {kTile + "&FILL=red", 400},
      {"/wmts.xml/x", 404}};
  for (const auto& [target, status] : wrong) {
    EXPECT_EQ(sample_.get(target).status, status) << target;
  }
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
