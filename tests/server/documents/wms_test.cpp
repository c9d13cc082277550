// WMS requests and answers, in both versions.
#include "server/documents/wms.h"

#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/grid/web_mercator.h"
#include "render/picture/png.h"
#include "render/picture/webp.h"
#include "server/config/load_config.h"
#include "server/tiles/open_fonts.h"
#include "tests/core/io/temporary_folder.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using testing::changed;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A tile of zoom 3 that contains a corner of the rings.
constexpr const char* kBox = "BBOX=-5009377.085697311,0,0,5009377.085697311";
const std::string kMap = std::string(
                             "/wms?SERVICE=WMS&VERSION=1.3.0&REQUEST=GetMap&LAYERS=rings&STYLES=&"
                             "CRS=EPSG:3857&WIDTH=256&HEIGHT=256&FORMAT=image/png&") +
                         kBox;
const std::string kOldMap = std::string(
                                "/wms?SERVICE=WMS&VERSION=1.1.1&REQUEST=GetMap&LAYERS=rings&"
                                "STYLES=&SRS=EPSG:3857&WIDTH=256&HEIGHT=256&FORMAT=image/png&") +
                            kBox;

const std::string kMapInfo =
    changed(kMap, "GetMap", "GetFeatureInfo") + "&QUERY_LAYERS=rings&I=250&J=250&INFO_FORMAT=";

class WmsTest : public ::testing::Test {
 protected:
  static SiteOptions options() {
    SiteOptions options;
    options.styles.emplace("night", testing::style_of("fill=navy&background=black"));
    options.styles.emplace("day", testing::style_of("fill=yellow&opacity=0.5"));
    options.map_pixels = 1'000'000;
    options.fonts = open_fonts({});
    return options;
  }
  Picture picture(const std::string& target) {
    const HttpResponse response = sample_.get(target);
    EXPECT_EQ(response.header("Content-Type"), "image/png") << target << "\n" << *response.body;
    return response.header("Content-Type") == "image/png" ? decode_png(*response.body) : Picture();
  }
  testing::SampleSite sample_{true, {}, options()};
};

TEST_F(WmsTest, AMapOfATileIsTheTileOverWhite) {
  const auto tile = sample_.get("/tiles/rings/3/3/3.png?background=fff");
  for (const std::string& target :
       {kMap, kOldMap, changed(kMap, "3857", "900913"), changed(kMap, "3857", "102100"),
        changed(kMap, "SERVICE=WMS&VERSION=1.3.0&REQUEST", "request"),
        changed(kMap, "image/png", "IMAGE/PNG;%20mode=8bit"), kMap + "&TRANSPARENT=false",
        kMap + "&BGCOLOR=0xffFFff&map=any.map&foo=bar", kMap + "&DPI=96&MAP_RESOLUTION=96"}) {
    const auto map = sample_.get(target);
    EXPECT_EQ(map.status, 200) << target;
    EXPECT_EQ(*map.body, *tile.body) << target;
    EXPECT_EQ(map.header("ETag"), tile.header("ETag")) << target;
  }
}

TEST_F(WmsTest, BackgroundIsAsItIsAskedFor) {
  const auto clear = sample_.get("/tiles/rings/3/3/3.png");
  EXPECT_EQ(*sample_.get(kMap + "&TRANSPARENT=TRUE").body, *clear.body);
  EXPECT_EQ(*sample_.get(kMap + "&TRANSPARENT=TRUE&BGCOLOR=0x00ff00").body, *clear.body);
  EXPECT_EQ(picture(kMap + "&BGCOLOR=0x00FF00").at(0, 0), (Rgba{0, 255, 0, 255}));
  EXPECT_EQ(picture(kMap + "&background=blue").at(0, 0), (Rgba{0, 0, 255, 255}));
}

TEST_F(WmsTest, LayersAreDrawnFromTheFirstOneUp) {
  const auto map = sample_.get(changed(kMap, "LAYERS=rings", "LAYERS=west,rings,west"));
  EXPECT_EQ(*map.body, *sample_.get("/tiles/west,rings/3/3/3.png?background=fff").body);
}

TEST_F(WmsTest, StylesAreOfTheirLayers) {
  const auto map = sample_.get(
      changed(changed(kMap, "LAYERS=rings", "LAYERS=west,rings"), "STYLES=", "STYLES=day,night"));
  EXPECT_EQ(*map.body, *sample_
                            .get("/tiles/west,rings/3/3/3.png?background=fff&west.fill=yellow&"
                                 "west.opacity=0.5&rings.fill=navy")
                            .body);
  const auto one = sample_.get(
      changed(changed(kMap, "LAYERS=rings", "LAYERS=west,rings"), "STYLES=", "STYLES=,night"));
  EXPECT_EQ(*one.body,
            *sample_.get("/tiles/west,rings/3/3/3.png?background=fff&rings.fill=navy").body);
  const auto own = sample_.get(changed(kMap, "STYLES=", "STYLES=default"));
  EXPECT_EQ(*own.body, *sample_.get(kMap).body);
  const auto over = sample_.get(changed(kMap, "STYLES=", "STYLES=night") + "&fill=red");
  EXPECT_EQ(*over.body, *sample_.get("/tiles/rings/3/3/3.png?background=fff&fill=red").body);
}

TEST(WmsStyleTest, ParametersOfTheQueryReplaceTheStyleInMapsAndLegends) {
  SiteOptions options;
  options.styles.emplace("numbers", testing::style_of("color-by=n&breaks=2&ramp=Blues"));
  testing::SampleSite sample(true, {}, options);
  const TemporaryFolder folder;
  sample.data().set(Dataset::load(
      layers_of_files({folder.write("rings.geojson", R"({"type": "FeatureCollection", "features": [
      {"type": "Feature", "properties": {"n": 1}, "geometry": {"type": "Polygon",
       "coordinates": [[[-40, 0.1], [-0.1, 0.1], [-0.1, 39], [-40, 39], [-40, 0.1]]]}}]})")})));
  const std::string classes = "&rings.color-by=n&rings.classes=1:ff0000";
  const auto map = sample.get(changed(kMap, "STYLES=", "STYLES=numbers") + classes);
  EXPECT_EQ(map.status, 200) << *map.body;
  EXPECT_EQ(*map.body, *sample.get(kMap + classes).body);
  const std::string legend = "/wms?REQUEST=GetLegendGraphic&FORMAT=application/json&LAYER=rings";
  EXPECT_EQ(*sample.get(legend + "&STYLE=numbers" + classes).body,
            *sample.get(legend + classes).body);
}

TEST(WmsStyleTest, StylesOfTheOperatorMaySetLockedParameters) {
  SiteOptions options;
  options.styles.emplace("night", testing::style_of("fill=navy"));
  options.fonts = open_fonts({});
  testing::SampleSite sample(true, {}, options);
  const TemporaryFolder folder;
  std::vector<LayerConfig> layers =
      layers_of_files({folder.write("rings.geojson", R"({"type": "Polygon", "coordinates":
      [[[-40, 0.1], [-0.1, 0.1], [-0.1, 39], [-40, 39], [-40, 0.1]]]})")});
  layers[0].locked = {ParameterId::fill};
  sample.data().set(Dataset::load(layers));
  const std::string night = changed(kMap, "STYLES=", "STYLES=night");
  const auto map = sample.get(night);
  EXPECT_EQ(map.status, 200) << *map.body;
  EXPECT_EQ(*map.body, *sample.get("/tiles/rings/3/3/3.png?background=fff&style=night").body);
  EXPECT_EQ(sample.get(night + "&fill=red").status, 400);
  const auto info = sample.get(changed(kMapInfo, "STYLES=", "STYLES=night") + "text/plain");
  EXPECT_EQ(info.status, 200) << *info.body;
  const std::string legend = "/wms?REQUEST=GetLegendGraphic&FORMAT=application/json&LAYER=rings";
  EXPECT_EQ(*sample.get(legend + "&STYLE=night").body,
            *sample.get("/legend/rings.json?style=night").body);
  EXPECT_EQ(sample.get(legend + "&STYLE=night&fill=red").status, 400);
}

TEST_F(WmsTest, FinerScreensHaveWiderLines) {
  const auto twice =
      sample_.get("/tiles/rings/3/3/3@2x.png?background=fff&stroke=000&stroke-width=3");
  const std::string large =
      changed(changed(kMap, "WIDTH=256", "WIDTH=512"), "HEIGHT=256", "HEIGHT=512") +
      "&stroke=000&stroke-width=3";
  for (const char* dpi : {"&DPI=192", "&MAP_RESOLUTION=192", "&FORMAT_OPTIONS=dpi:192",
                          "&format_options=antialias:on;dpi:192;x:y"}) {
    EXPECT_EQ(*sample_.get(large + dpi).body, *twice.body) << dpi;
  }
  EXPECT_NE(*sample_.get(large).body, *twice.body);
}

TEST_F(WmsTest, WebpIsWebp) {
  if (!has_webp()) GTEST_SKIP() << "built without WebP";
  const auto map = sample_.get(changed(kMap, "image/png", "image/webp"));
  EXPECT_EQ(map.header("Content-Type"), "image/webp");
  EXPECT_EQ(*map.body, *sample_.get("/tiles/rings/3/3/3.webp?background=fff").body);
}

TEST_F(WmsTest, PixelsNeedNotBeSquare) {
  const Picture map = picture(changed(kMap, "HEIGHT=256", "HEIGHT=64"));
  EXPECT_EQ(map.width, 256);
  EXPECT_EQ(map.height, 64);
  const Picture tile = picture(kMap);
  EXPECT_EQ(map.at(250, 62), tile.at(250, 250));
}

TEST_F(WmsTest, CapabilitiesTellOfLayersStylesAndLegends) {
  const auto response = sample_.get("/wms?service=WMS&request=GetCapabilities");
  ASSERT_EQ(response.status, 200);
  EXPECT_EQ(response.header("Content-Type"), "text/xml");
  for (const char* part :
       {"version=\"1.3.0\"", "<Name>WMS</Name>", "<Name>rings</Name>", "<Title>Rings</Title>",
        "<CRS>EPSG:3857</CRS>", "<CRS>EPSG:900913</CRS>", "<MaxWidth>1000</MaxWidth>",
        "<Attribution><Title>drawn by hand</Title></Attribution>",
        "<westBoundLongitude>-90</westBoundLongitude>",
        "<BoundingBox CRS=\"EPSG:3857\" minx=\"-10018754.1", "<Name>night</Name>",
        "http://maps.example:8080/legend/rings.png?style=night", "<Format>INIMAGE</Format>",
        "xlink:href=\"http://maps.example:8080/wms?\"", "queryable=\"1\"",
        "<MinScaleDenominator>8735660.3", "<sld:GetLegendGraphic>"}) {
    EXPECT_THAT(*response.body, HasSubstr(part));
  }
  EXPECT_THAT(*response.body, Not(HasSubstr("MaxScaleDenominator"))) << "from zoom 0 on";
  const auto old = sample_.get("/wms?service=WMS&request=GetCapabilities&version=1.1.1");
  EXPECT_EQ(old.header("Content-Type"), "application/vnd.ogc.wms_xml");
  for (const char* part :
       {"<WMT_MS_Capabilities version=\"1.1.1\">", "<Name>OGC:WMS</Name>", "<SRS>EPSG:3857</SRS>",
        "<LatLonBoundingBox minx=\"-90\"", "application/vnd.ogc.se_inimage", "<ScaleHint min="}) {
    EXPECT_THAT(*old.body, HasSubstr(part));
  }
}

TEST_F(WmsTest, CapabilitiesTellOfTheScaleBeyondWhichMapsAreRefused) {
  EXPECT_THAT(*sample_.get("/wms?service=WMS&request=GetCapabilities").body,
              HasSubstr("<MinScaleDenominator>33.3"))
      << "zoom 24";
  SiteOptions options;
  options.max_zoom = 3;
  testing::SampleSite coarse(true, {}, options);
  const std::string xml = *coarse.get("/wms?service=WMS&request=GetCapabilities").body;
  EXPECT_THAT(xml, HasSubstr("<MinScaleDenominator>69885283.0"));
  EXPECT_THAT(xml, Not(HasSubstr("<MinScaleDenominator>8735660.3")));
}

TEST_F(WmsTest, CapabilitiesKeepTheStyleOfTheirQueryInAddresses) {
  const auto response = sample_.get(
      "/wms?service=WMS&request=GetCapabilities&rings.fill=%23f00&map=any&filter=a%3C%26b");
  EXPECT_THAT(*response.body,
              HasSubstr("xlink:href=\"http://maps.example:8080/wms?rings.fill=%23f00&amp;"
                        "filter=a%3C%26b&amp;\""));
}

TEST_F(WmsTest, LegendsAreAsLargeAsTheCapabilitiesSay) {
  const auto response = sample_.get("/wms?service=WMS&request=GetCapabilities");
  const Picture legend = picture("/legend/rings.png?style=night");
  EXPECT_THAT(*response.body, HasSubstr(fmt::format("<LegendURL width=\"{}\" height=\"{}\">",
                                                    legend.width, legend.height)));
  const std::string target =
      "/wms?SERVICE=WMS&VERSION=1.3.0&REQUEST=GetLegendGraphic&LAYER=rings"
      "&FORMAT=image/png&STYLE=night&SLD_VERSION=1.1.0";
  EXPECT_EQ(*sample_.get(target).body, *sample_.get("/legend/rings.png?style=night").body);
  EXPECT_EQ(*sample_.get(target + "&DPI=192").body,
            *sample_.get("/legend/rings@2x.png?style=night").body);
}

TEST_F(WmsTest, VersionsAreNegotiated) {
  const std::pair<const char*, const char*> versions[] = {
      {"", "version=\"1.3.0\""},      {"1.3.0", "version=\"1.3.0\""}, {"1.3", "version=\"1.3.0\""},
      {"1.1.1", "version=\"1.1.1\""}, {"1.1.0", "version=\"1.1.1\""}, {"0.9", "version=\"1.1.1\""},
      {"1.2.5", "version=\"1.1.1\""}, {"9.9.9", "version=\"1.3.0\""}};
  for (const auto& [asked, answered] : versions) {
    const auto response =
        sample_.get(fmt::format("/wms?service=WMS&request=GetCapabilities&version={}", asked));
    EXPECT_THAT(*response.body, HasSubstr(answered)) << asked;
  }
}

TEST_F(WmsTest, WhatTheConfigurationSaysIsEscaped) {
  auto layers = layers_of_files({testing::fixture("rings.geojson")});
  layers[0].title = "<Ä & \"B\">";
  layers[0].description = layers[0].attribution = layers[0].title;
  sample_.data().set(Dataset::load(layers));
  for (const char* version : {"1.1.1", "1.3.0"}) {
    const auto response =
        sample_.get(fmt::format("/wms?service=WMS&request=GetCapabilities&version={}", version));
    EXPECT_THAT(*response.body, HasSubstr("<Title>&lt;Ä &amp; &quot;B&quot;&gt;</Title>"));
    EXPECT_THAT(*response.body, Not(HasSubstr("<Ä")));
  }
}

TEST_F(WmsTest, FeaturesUnderAPixelAreTold) {
  const auto json = sample_.get(kMapInfo + "application/geo%2Bjson");
  ASSERT_EQ(json.status, 200) << *json.body;
  EXPECT_EQ(json.header("Content-Type"), "application/geo+json");
  EXPECT_EQ(nlohmann::json::parse(*json.body)["features"][0]["layer"], "rings");
  EXPECT_THAT(*sample_.get(kMapInfo + "text/plain").body, HasSubstr("layer = rings"));
  EXPECT_THAT(*sample_.get(kMapInfo + "text/html").body, HasSubstr("<td>rings</td>"));
  const auto old = sample_.get(changed(kOldMap, "GetMap", "GetFeatureInfo") +
                               "&QUERY_LAYERS=rings&X=250&Y=250&INFO_FORMAT=text/plain");
  EXPECT_THAT(*old.body, HasSubstr("layer = rings"));
  const auto outside = sample_.get(changed(kMapInfo, "I=250&J=250", "I=0&J=0") + "text/plain");
  EXPECT_THAT(*outside.body, Not(HasSubstr("rings")));
}

TEST_F(WmsTest, FeaturesAreAsManyOfALayerAsAskedFor) {
  const TemporaryFolder folder;
  std::string features;
  for (int i = 0; i < 5; ++i) {
    features += fmt::format("{}{}", i == 0 ? "" : ",", R"({"type": "Feature", "properties": {},
      "geometry": {"type": "Polygon",
                   "coordinates": [[[-40, 0.1], [-0.1, 0.1], [-0.1, 39], [-40, 39], [-40, 0.1]]]}})");
  }
  const std::string file = folder.write(
      "rings.geojson", R"({"type": "FeatureCollection", "features": [)" + features + "]}");
  sample_.data().set(Dataset::load(layers_of_files({file})));
  const auto count = [this](const std::string& more) {
    const auto response = sample_.get(kMapInfo + "application/json" + more);
    return nlohmann::json::parse(*response.body)["features"].size();
  };
  EXPECT_EQ(count(""), 1u);
  EXPECT_EQ(count("&FEATURE_COUNT=3"), 3u);
  EXPECT_EQ(count("&FEATURE_COUNT=1000"), 5u);
}

TEST_F(WmsTest, TellsWhatIsWrongInTheWordsOfItsVersion) {
  struct Case {
    std::string target;
    const char* code;
    const char* locator;
  };
  const auto without = [](const std::string& key) {
    const std::size_t at = kMap.find(key + "=");
    return kMap.substr(0, at) + "_" + kMap.substr(at);
  };
  const Case cases[] = {
      {"/wms", "MissingParameterValue", "REQUEST"},
      {"/wms?request=GetCapabilities", "MissingParameterValue", "SERVICE"},
      {"/wms?service=WFS&request=GetCapabilities", "InvalidParameterValue", "SERVICE"},
      {changed(kMap, "SERVICE=WMS", "SERVICE=WFS"), "InvalidParameterValue", "SERVICE"},
      {changed(kMap, "GetMap", "GetCake"), "OperationNotSupported", "REQUEST"},
      {changed(kMap, "LAYERS=rings", "LAYERS="), "MissingParameterValue", "LAYERS"},
      {changed(kMap, "LAYERS=rings", "LAYERS=cake"), "LayerNotDefined", "LAYERS"},
      {changed(kMap, "LAYERS=rings", "LAYERS=%3Cb%3E"), "LayerNotDefined", "LAYERS"},
      {changed(kMap, "STYLES=", "STYLES=cake"), "StyleNotDefined", "STYLES"},
      {changed(kMap, "STYLES=", "STYLES=day,night"), "StyleNotDefined", "STYLES"},
      {changed(kMap, "EPSG:3857", "EPSG:2056"), "InvalidCRS", "CRS"},
      {without("CRS"), "MissingParameterValue", "CRS"},
      {without("BBOX"), "MissingParameterValue", "BBOX"},
      {changed(kMap, "BBOX=-5", "BBOX=5"), "InvalidParameterValue", "BBOX"},
      {changed(kMap, "BBOX=-5", "BBOX=x"), "InvalidParameterValue", "BBOX"},
      {changed(kMap, "WIDTH=256", "WIDTH=0"), "InvalidParameterValue", "WIDTH"},
      {changed(kMap, "WIDTH=256", "WIDTH=-256"), "InvalidParameterValue", "WIDTH"},
      {changed(kMap, "WIDTH=256", "WIDTH=1e3"), "InvalidParameterValue", "WIDTH"},
      {changed(kMap, "HEIGHT=256", "HEIGHT=16000"), "InvalidParameterValue", "width"},
      {without("HEIGHT"), "MissingParameterValue", "HEIGHT"},
      {without("FORMAT"), "MissingParameterValue", "FORMAT"},
      {changed(kMap, "image/png", "image/gif"), "InvalidFormat", "FORMAT"},
      {kMap + "&TRANSPARENT=maybe", "InvalidParameterValue", "TRANSPARENT"},
      {kMap + "&BGCOLOR=red", "InvalidParameterValue", "BGCOLOR"},
      {kMap + "&DPI=0", "InvalidParameterValue", "DPI"},
      {kMap + "&DPI=1e9", "InvalidParameterValue", "DPI"},
      {kMap + "&SLD=http://other.example/a.sld", "OperationNotSupported", "SLD"},
      {kMap + "&WIDTH=256", "InvalidParameterValue", "WIDTH"},
      {kMap + "&fill=cake", "InvalidParameterValue", "fill"},
      {kMapInfo + "image/png", "InvalidFormat", "INFO_FORMAT"},
      {changed(kMapInfo, "I=250", "I=256") + "text/plain", "InvalidPoint", "I"},
      {changed(kMapInfo, "J=250", "J=-1") + "text/plain", "InvalidPoint", "J"},
      {changed(kMapInfo, "QUERY_LAYERS=rings", "QUERY_LAYERS=west") + "text/plain",
       "LayerNotDefined", "QUERY_LAYERS"},
      {kMapInfo + "text/plain&FEATURE_COUNT=0", "InvalidParameterValue", "FEATURE_COUNT"},
      {"/wms?service=WMS&request=GetLegendGraphic&layer=cake", "LayerNotDefined", "LAYER"},
      {"/wms?service=WMS&request=GetLegendGraphic&layer=rings&style=cake", "StyleNotDefined",
       "STYLE"},
  };
  for (const Case& one : cases) {
    const auto response = sample_.get(one.target);
    EXPECT_GE(response.status, 400) << one.target;
    EXPECT_EQ(response.header("Content-Type"), "text/xml") << one.target;
    EXPECT_THAT(*response.body,
                HasSubstr(fmt::format("code=\"{}\" locator=\"{}\"", one.code, one.locator)))
        << one.target;
    EXPECT_THAT(*response.body, Not(HasSubstr("<b>")));
  }
  const auto old = sample_.get(changed(kOldMap, "EPSG:3857", "EPSG:2056"));
  EXPECT_EQ(old.header("Content-Type"), "application/vnd.ogc.se_xml");
  EXPECT_THAT(*old.body, HasSubstr("<ServiceExceptionReport version=\"1.1.1\">"));
  EXPECT_THAT(*old.body, HasSubstr("<ServiceException code=\"InvalidSRS\">"));
}

TEST_F(WmsTest, WhatIsWrongIsToldInThePictureIfThatIsAskedFor) {
  const std::string bad = changed(kMap, "LAYERS=rings", "LAYERS=cake");
  const auto ink = [](const Picture& picture) {
    return std::ranges::count_if(picture.pixels, [&](Rgba p) { return p != picture.at(0, 0); });
  };
  for (const char* name : {"INIMAGE", "application/vnd.ogc.se_inimage"}) {
    const Picture told = picture(bad + "&EXCEPTIONS=" + name);
    ASSERT_EQ(told.width, 256);
    EXPECT_EQ(told.at(0, 0), (Rgba{255, 255, 255, 255}));
    EXPECT_GT(ink(told), 200);
  }
  const Picture blank = picture(bad + "&EXCEPTIONS=BLANK&BGCOLOR=0x00FF00");
  EXPECT_EQ(blank.at(0, 0), (Rgba{0, 255, 0, 255}));
  EXPECT_EQ(ink(blank), 0);
  const Picture clear = picture(bad + "&EXCEPTIONS=BLANK&TRANSPARENT=TRUE");
  EXPECT_EQ(clear.at(0, 0).a, 0);
  EXPECT_EQ(sample_.get(bad + "&EXCEPTIONS=BLANK").header("Cache-Control"), "no-store");
  // Sizes that are zero, too large or not numbers give no picture.
  for (const char* width : {"WIDTH=0", "WIDTH=16384", "WIDTH=x"}) {
    const auto response =
        sample_.get(changed(bad, "WIDTH=256", width) + "&HEIGHT=256&" + "EXCEPTIONS=INIMAGE");
    EXPECT_EQ(response.header("Content-Type"), "text/xml") << width;
  }
}

TEST_F(WmsTest, DocumentsAreWellFormed) {
  const TemporaryFolder folder;
  for (const std::string& target :
       {std::string("/wms?service=WMS&request=GetCapabilities"),
        std::string("/wms?service=WMS&request=GetCapabilities&version=1.1.1"),
        changed(kMap, "LAYERS=rings", "LAYERS=%3Ccake%26"),
        changed(kOldMap, "LAYERS=rings", "LAYERS=%3Ccake%26")}) {
    const std::string file = folder.write("document.xml", *sample_.get(target).body);
    const int status = std::system(("command -v xmllint >/dev/null || exit 0; xmllint --noout "
                                    "--nonet " +
                                    file)
                                       .c_str());
    EXPECT_EQ(status, 0) << target;
  }
}

}  // namespace
}  // namespace trapeze
