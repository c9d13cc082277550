// Compares the table of routes with the server's answers and its documents.
#include "server/documents/routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "server/base/url.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;

TEST(RoutesTest, AreaIsOneOfAFewWhateverTheTarget) {
  const std::pair<const char*, Area> areas[] = {{"/tiles/a/0/0/0.png", Area::tiles},
                                                {"/tiles/a.json", Area::tiles},
                                                {"/legend/a.png", Area::legend},
                                                {"/wmts.xml", Area::wmts},
                                                {"/wmts", Area::wmts},
                                                {"/ogc", Area::ogc},
                                                {"/metrics", Area::metrics},
                                                {"/", Area::other},
                                                {"/index.html", Area::other},
                                                {"", Area::other},
                                                {"/tilesx/a", Area::other},
                                                {"/legend.png", Area::other},
                                                {"//tiles/a", Area::other},
                                                {"/%74iles/a", Area::other}};
  for (const auto& [path, area] : areas) {
    EXPECT_EQ(name_of(area_of(path)), name_of(area)) << path;
  }
}

TEST(RoutesTest, SegmentsFindTheirRoute) {
  const auto id_of = [](const std::string& path) {
    const Route* route = find_route(decode_path(path).value());
    return route == nullptr ? "nothing" : std::string(route->path);
  };
  EXPECT_EQ(id_of("/tiles/a,b/1/0/0.png"), "/tiles/{layers}/{z}/{x}/{y}.png");
  EXPECT_EQ(id_of("/tiles/a,b/s/night/1/0/0.png"), "/tiles/{layers}/s/{style}/{z}/{x}/{y}.png");
  EXPECT_EQ(id_of("/tiles/a.json"), "/tiles/{layers}.json");
  EXPECT_EQ(id_of("/styles"), "/styles");
  EXPECT_EQ(id_of("/ogc/map/tiles"), "/ogc/map/tiles");
  EXPECT_EQ(id_of("/ogc/map/tiles/a"), "/ogc/map/tiles/{tileMatrixSetId}");
  EXPECT_EQ(id_of("/ogc/map"), "/ogc/map");
  EXPECT_EQ(id_of("/ogc/maps"), "nothing");
  EXPECT_EQ(id_of("/ogc/conformance/more"), "nothing");
}

TEST(RoutesTest, MethodsAreThoseOfThePath) {
  EXPECT_EQ(methods_of("/styles"), "GET, HEAD, OPTIONS, POST");
  EXPECT_EQ(methods_of("/styles/night"), "GET, HEAD, OPTIONS");
  EXPECT_TRUE(understands("/styles", "POST"));
  EXPECT_FALSE(understands("/styles", "POS"));
  EXPECT_FALSE(understands("/styles/night", "POST"));
  EXPECT_FALSE(understands("/anything", "DELETE"));
}

/// The path with its {placeholders} filled in.
std::string filled_in(std::string path) {
  const std::map<std::string, std::string> values = {{"layers", "rings"},
                                                     {"z", "0"},
                                                     {"x", "0"},
                                                     {"y", "0"},
                                                     {"style", "default"},
                                                     {"place", "10,10"},
                                                     {"centre", "10,10,3"},
                                                     {"size", "64x48"},
                                                     {"layer", "rings"},
                                                     {"attribute", "rank"},
                                                     {"collectionId", "rings"},
                                                     {"tileMatrixSetId", "WebMercatorQuad"},
                                                     {"tileMatrix", "0"},
                                                     {"tileRow", "0"},
                                                     {"tileCol", "0"},
                                                     {"i", "0"},
                                                     {"j", "0"}};
  for (const auto& [name, value] : values) {
    const std::string braced = "{" + name + "}";
    const std::size_t at = path.find(braced);
    if (at != std::string::npos) path.replace(at, braced.size(), value);
  }
  return path;
}

class AllRoutesTest : public ::testing::Test {
 protected:
  static SiteOptions options() {
    SiteOptions options;
    options.metrics = [] { return std::string("# nothing\n"); };
    options.styles.emplace("night", testing::style_of("fill=navy"));
    return options;
  }
  testing::SampleSite site_{true, {}, options()};
};

TEST_F(AllRoutesTest, AreAnsweredWithWhatTheyPromise) {
  for (const Route& route : routes()) {
    if (route.method != "GET") continue;
    std::string target = filled_in(std::string(route.path));
    if (route.id == RouteId::style) target = "/styles/night";
    if (route.id == RouteId::value_table) {
      const auto posted = site_.handle({"POST", "/values", "maps.example:8080", {}, "k,v\na,1\n"});
      target = posted.header("Location");
    }
    if (route.id == RouteId::wmts_key_values) target += "?service=WMTS&request=GetCapabilities";
    if (route.id == RouteId::wms) target += "?service=WMS&request=GetCapabilities";
    if (route.id == RouteId::map_window) target += "?bbox=-10,-10,20,10&width=64";
    const HttpResponse response = site_.get(target);
    EXPECT_EQ(response.status, 200) << target << ": " << *response.body;
    EXPECT_THAT(std::string(response.header("Content-Type")),
                HasSubstr(std::string(route.content_type)))
        << target;
  }
}

TEST_F(AllRoutesTest, AreToldByOpenApi) {
  const auto api = nlohmann::json::parse(*site_.get("/ogc/api").body);
  std::size_t told = 0;
  for (const Route& route : routes()) {
    if (route.operation.empty()) continue;
    const auto& methods = api["paths"].at(std::string(route.path));
    EXPECT_EQ(methods.at(route.method == "POST" ? "post" : "get")["operationId"], route.operation);
    ++told;
  }
  std::size_t operations = 0;
  for (const auto& [path, methods] : api["paths"].items()) operations += methods.size();
  EXPECT_EQ(operations, told);
}

TEST(RoutesTest, EveryOneIsInTheTableOfTheDocuments) {
  std::ifstream file(TRAPEZE_DOCS "/urls.md");
  std::ostringstream text;
  text << file.rdbuf();
  for (const Route& route : routes()) {
    EXPECT_THAT(text.str(), HasSubstr("\n| `" + std::string(route.path) + "` | "));
  }
}

// What the table promises is still there.
TEST(RoutesTest, WhatIsInTheTableOfTheDocumentsIsARoute) {
  std::ifstream file(TRAPEZE_DOCS "/urls.md");
  std::size_t paths = 0;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("| `/")) continue;
    const std::string path = line.substr(3, line.find('`', 3) - 3);
    if (path == "/") continue;  // the viewer, a file
    ++paths;
    EXPECT_TRUE(std::ranges::any_of(routes(), [&](const Route& route) {
      return route.path == path;
    })) << path;
  }
  EXPECT_GT(paths, 40u);
}

}  // namespace
}  // namespace trapeze
