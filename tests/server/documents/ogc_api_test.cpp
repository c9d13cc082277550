#include "server/documents/ogc_api.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "server/styles/style_parameters.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::Contains;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::string_view kHost = "http://maps.example:8080";
const std::string kTiles = "/ogc/collections/rings/map/tiles/WebMercatorQuad";

class OgcApiTest : public ::testing::Test {
 protected:
  nlohmann::json json(const std::string& target) {
    const auto response = sample_.get(target);
    EXPECT_EQ(response.status, 200) << target;
    return nlohmann::json::parse(*response.body);
  }
  /// The URL of the first link with that relation, as a target of this server.
  static std::string link(const nlohmann::json& document, const std::string& relation) {
    for (const auto& link : document["links"]) {
      if (link["rel"] != relation) continue;
      const auto href = link["href"].get<std::string>();
      EXPECT_THAT(href, StartsWith(std::string(kHost))) << "links are absolute";
      return href.substr(kHost.size());
    }
    ADD_FAILURE() << "there is no link " << relation;
    return {};
  }

  testing::SampleSite sample_;
};

TEST_F(OgcApiTest, TheLinksLeadFromTheLandingPageToATile) {
  const auto landing = json("/ogc");
  const auto collections = json(link(landing, "data"));
  ASSERT_EQ(collections["collections"].size(), 2u);
  const auto& rings = collections["collections"][0];
  EXPECT_EQ(rings["id"], "rings");
  EXPECT_EQ(rings["title"], "Rings");
  const std::string self = link(rings, "self");
  EXPECT_EQ(json(self), rings);
  const auto tilesets = json(link(rings, "http://www.opengis.net/def/rel/ogc/1.0/tilesets-map"));
  ASSERT_EQ(tilesets["tilesets"].size(), 2u);
  EXPECT_EQ(tilesets["tilesets"][0]["dataType"], "map");
  EXPECT_EQ(tilesets["tilesets"][0]["tileMatrixSetURI"],
            "http://www.opengis.net/def/tilematrixset/OGC/1.0/WebMercatorQuad");
  const auto tileset = json(link(tilesets["tilesets"][0], "self"));
  std::string tile = link(tileset, "item");
  EXPECT_THAT(tile, EndsWith("/{tileMatrix}/{tileRow}/{tileCol}"));
  tile.replace(tile.find("{tileMatrix}"), std::string::npos, "2/1/3");
  EXPECT_EQ(*sample_.get(tile).body, *sample_.get("/tiles/rings/2/3/1.png").body);
  const auto matrices = json(link(tileset, "http://www.opengis.net/def/rel/ogc/1.0/tiling-scheme"));
  EXPECT_EQ(matrices["id"], "WebMercatorQuad");
  EXPECT_EQ(matrices, json("/ogc/tileMatrixSets/WebMercatorQuad"));
}

/// All links of a document, also those of its parts.
void append_links(const nlohmann::json& part, std::vector<nlohmann::json>& links) {
  if (!part.is_structured()) return;
  for (const auto& [name, value] : part.items()) {
    if (part.is_object() && name == "links") {
      links.insert(links.end(), value.begin(), value.end());
    } else {
      append_links(value, links);
    }
  }
}

TEST_F(OgcApiTest, EveryLinkLeadsSomewhere) {
  for (const char* target : {"/ogc", "/ogc/", "/ogc/collections", "/ogc/collections/west",
                             "/ogc/map/tiles", "/ogc/map/tiles/WebMercatorQuad",
                             "/ogc/tileMatrixSets", "/ogc/collections/west/map/tiles"}) {
    std::vector<nlohmann::json> links;
    append_links(json(target), links);
    EXPECT_FALSE(links.empty()) << target;
    for (const auto& item : links) {
      if (item.contains("templated")) continue;
      const auto href = item["href"].get<std::string>();
      const auto response = sample_.get(href.substr(kHost.size()));
      EXPECT_EQ(response.status, 200) << target << " " << href;
      EXPECT_EQ(response.header("Content-Type"), item["type"].get<std::string>()) << href;
    }
  }
}

TEST_F(OgcApiTest, RowsComeBeforeColumns) {
  EXPECT_EQ(*sample_.get(kTiles + "/3/2/5").body, *sample_.get("/tiles/rings/3/5/2.png").body);
  EXPECT_EQ(sample_.get(kTiles + "/3/2/5").header("Content-Type"), "image/png");
}

TEST_F(OgcApiTest, TheDatasetIsAllLayersOrThoseChosen) {
  const std::string tiles = "/ogc/map/tiles/WebMercatorQuad/0/0/0";
  EXPECT_EQ(*sample_.get(tiles).body, *sample_.get("/tiles/rings,west/0/0/0.png").body);
  EXPECT_EQ(*sample_.get(tiles + "?collections=west").body,
            *sample_.get("/tiles/west/0/0/0.png").body);
  const auto tileset = json("/ogc/map/tiles/WebMercatorQuad?collections=west,rings&fill=red");
  EXPECT_THAT(link(tileset, "item"), EndsWith("?collections=west,rings&fill=ff0000ff"));
  for (const std::string& path : {tiles, std::string("/ogc/map/tiles/WebMercatorQuad")}) {
    const auto unknown = sample_.get(path + "?collections=west,nosuch");
    EXPECT_EQ(unknown.status, 404);
    EXPECT_THAT(*unknown.body, HasSubstr("There is no layer \\\"nosuch\\\""));
  }
  EXPECT_EQ(sample_.get(tiles + "?collections=").status, 400);
}

TEST_F(OgcApiTest, TheStyleOfTheQueryIsInTheTilesAndInTheirLinks) {
  EXPECT_EQ(*sample_.get(kTiles + "/0/0/0?fill=lime&f=png").body,
            *sample_.get("/tiles/rings/0/0/0.png?fill=lime").body);
  const auto tilesets = json("/ogc/collections/rings/map/tiles?fill=lime&_=1");
  const auto tileset = json(link(tilesets["tilesets"][0], "self"));
  EXPECT_THAT(link(tileset, "item"), EndsWith("{tileCol}?fill=00ff00ff"));
}

TEST_F(OgcApiTest, TheTilesetTellsWhereTheDataIs) {
  const auto tileset = json("/ogc/collections/west/map/tiles/WebMercatorQuad");
  const auto& limits = tileset["tileMatrixSetLimits"];
  ASSERT_EQ(limits.size(), 6u) << "zooms 0 to 5";
  EXPECT_EQ(limits[1]["tileMatrix"], "1");
  EXPECT_EQ(limits[5]["minTileRow"], 0);
  EXPECT_EQ(limits[5]["minTileCol"], 0);
  EXPECT_EQ(limits[5]["maxTileCol"], 31);
  EXPECT_EQ(limits[5]["maxTileRow"], 31);
  EXPECT_NEAR(tileset["boundingBox"]["upperRight"][0], 0, 1e-6);
}

TEST_F(OgcApiTest, TheMatricesAreThoseOfTheRegistry) {
  const auto set = json("/ogc/tileMatrixSets/WebMercatorQuad");
  ASSERT_EQ(set["tileMatrices"].size(), 25u);
  EXPECT_NEAR(set["tileMatrices"][0]["scaleDenominator"], 559082264.028717, 1e-4);
  EXPECT_NEAR(set["tileMatrices"][24]["cellSize"], 0.009330692, 1e-8);
  EXPECT_EQ(set["tileMatrices"][24]["matrixWidth"], 16777216);
  EXPECT_EQ(set["tileMatrices"][7]["tileWidth"], 256);
}

TEST_F(OgcApiTest, WhatIsNotThereIsNotFoundAndWhatIsWrongIsSaid) {
  for (const std::string& target :
       {std::string("/ogc/nosuch"), std::string("/ogc/collections/nosuch"),
        std::string("/ogc/collections/nosuch/map/tiles"),
        std::string("/ogc/collections/nosuch/map/tiles/WebMercatorQuad/0/0/0"),
        std::string("/ogc/collections/rings,west"), std::string("/ogc/tileMatrixSets/nosuch"),
        std::string("/ogc/collections/rings/map/tiles/nosuch"),
        std::string("/ogc/collections/rings/map/tiles/nosuch/0/0/0"), kTiles + "/1/2/0",
        kTiles + "/25/0/0", kTiles + "/0/0", kTiles + "/0/0/0/0"}) {
    EXPECT_EQ(sample_.get(target).status, 404) << target;
  }
  for (const std::string& target :
       {kTiles + "/0/0/a", kTiles + "/0/0/0?fill=no", kTiles + "/0/0/0?f=jpeg",
        std::string("/ogc?f=html"), std::string("/ogc/%zz"), kTiles + "?fill=no"}) {
    EXPECT_EQ(sample_.get(target).status, 400) << target;
  }
}

TEST_F(OgcApiTest, ConformanceIsTold) {
  const auto classes = json("/ogc/conformance")["conformsTo"];
  EXPECT_THAT(classes, Contains("http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/core"));
  EXPECT_THAT(classes, Contains("http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/png"));
  const std::set<std::string> different(classes.begin(), classes.end());
  EXPECT_EQ(different.size(), classes.size());
}

TEST_F(OgcApiTest, TilesCanBeCached) {
  const std::string tag(sample_.get(kTiles + "/0/0/0").header("ETag"));
  EXPECT_EQ(sample_.get(kTiles + "/0/0/0", tag).status, 304);
  EXPECT_EQ(sample_.get("/tiles/rings/0/0/0.png", tag).status, 304) << "it is the same picture";
}

class OpenApiTest : public OgcApiTest {};

TEST_F(OpenApiTest, DescribesEveryParameterOfTheTable) {
  const auto response = sample_.get("/ogc/api");
  EXPECT_EQ(response.header("Content-Type"), "application/vnd.oai.openapi+json;version=3.0");
  const auto api = nlohmann::json::parse(*response.body);
  EXPECT_THAT(api["openapi"].get<std::string>(), StartsWith("3.0."));
  EXPECT_EQ(api["servers"][0]["url"], std::string(kHost));
  for (const StyleParameter& parameter : style_parameters()) {
    const auto& described = api["components"]["parameters"][std::string(parameter.name)];
    EXPECT_EQ(described["name"], std::string(parameter.name));
    EXPECT_EQ(described["in"], "query");
    EXPECT_TRUE(described["schema"].contains("type")) << parameter.name;
  }
  EXPECT_EQ(api["components"]["parameters"]["fill-opacity"]["schema"]["maximum"], 1);
}

/// Every {name} in the path.
std::set<std::string> templates_of(const std::string& path) {
  std::set<std::string> names;
  for (std::size_t open = path.find('{'); open != std::string::npos;
       open = path.find('{', open + 1)) {
    names.insert(path.substr(open + 1, path.find('}', open) - open - 1));
  }
  return names;
}

TEST_F(OpenApiTest, ReferencesExistAndPathsNameTheirParameters) {
  const auto api = json("/ogc/api");
  std::set<std::string> ids;
  for (const auto& [path, item] : api["paths"].items()) {
    const auto& get = item["get"];
    EXPECT_TRUE(ids.insert(get["operationId"]).second) << get["operationId"];
    EXPECT_TRUE(get["responses"].contains("200")) << path;
    std::set<std::string> in_path;
    for (const auto& reference : get.value("parameters", nlohmann::json::array())) {
      const auto pointer = reference["$ref"].get<std::string>();
      const auto& parameter = api.at(nlohmann::json::json_pointer(pointer.substr(1)));
      if (parameter["in"] == "path") in_path.insert(parameter["name"]);
    }
    EXPECT_EQ(in_path, templates_of(path)) << path;
  }
}

}  // namespace
}  // namespace trapeze
