#include "server/service/site.h"

#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "render/picture/png.h"
#include "server/config/load_config.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;

constexpr Rgba kRed{255, 0, 0, 255};
constexpr Rgba kBlueHalf{0, 0, 255, 128};

Picture picture_of(const HttpResponse& response) {
  return decode_png(*response.body);
}

class SiteTest : public ::testing::Test {
 protected:
  HttpResponse get(const std::string& target, const std::string& if_none_match = {}) {
    return sample_.get(target, if_none_match);
  }
  HttpResponse get_compressed(const std::string& target, const std::string& accept_encoding,
                              const std::string& if_none_match = {}) {
    HttpRequest request{"GET", target, "maps.example:8080", if_none_match, {}};
    request.accept_encoding = accept_encoding;
    return sample_.handle(request);
  }
  int status(const std::string& target) { return get(target).status; }
  nlohmann::json json(const std::string& target) {
    return nlohmann::json::parse(*get(target).body);
  }

  testing::SampleSite sample_;
};

TEST_F(SiteTest, ATileShowsInsideAndOutsideWhereTheyAre) {
  const auto response = get("/tiles/rings/0/0/0.png");
  ASSERT_EQ(response.status, 200);
  EXPECT_EQ(response.header("Content-Type"), "image/png");
  const Picture picture = picture_of(response);
  ASSERT_EQ(picture.width, 256);
  ASSERT_EQ(picture.height, 256);
  const auto ring_of = [](int i) { return i >= 64 && i < 192; };
  const auto hole_of = [](int i) { return i >= 96 && i < 160; };
  const auto island_of = [](int i) { return i >= 112 && i < 144; };
  int wrong = 0;
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      const bool is_inside = (ring_of(x) && ring_of(y) && !(hole_of(x) && hole_of(y))) ||
                             (island_of(x) && island_of(y));
      const Rgba pixel = picture.at(x, y);
      wrong += is_inside ? pixel != kRed : pixel.a != 0;
    }
  }
  EXPECT_EQ(wrong, 0);
}

TEST_F(SiteTest, WhoeverHasATileIsToldSoWithoutWaitingForAWorker) {
  const std::string target = "/tiles/rings,west/1/0/0.png?rings.stroke=black";
  const std::string tag(get(target).header("ETag"));
  testing::SampleSite other;  // which has drawn nothing
  const auto answer_at_once = [&](const std::string& if_none_match) {
    auto answer = std::make_shared<std::promise<HttpResponse>>();
    auto answered = answer->get_future();
    other.site().handle(
        {"GET", target, "maps.example:8080", if_none_match, {}},
        [answer](HttpResponse response) { answer->set_value(std::move(response)); });
    const bool is_at_once = answered.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    return std::pair(answered.get(), is_at_once);
  };
  const auto [same, is_at_once] = answer_at_once(tag);
  EXPECT_EQ(same.status, 304);
  EXPECT_EQ(same.header("ETag"), tag);
  EXPECT_TRUE(is_at_once);
  const auto [drawn, is_drawn_at_once] = answer_at_once("\"another\"");
  EXPECT_EQ(drawn.status, 200);
  EXPECT_EQ(drawn.header("ETag"), tag);
  EXPECT_EQ(drawn.header("X-Cache"), "MISS");
  EXPECT_EQ(*drawn.body, *get(target).body);
}

TEST_F(SiteTest, ScaleMultipliesThePixels) {
  const Picture picture = picture_of(get("/tiles/rings/0/0/0@3x.png"));
  ASSERT_EQ(picture.width, 768);
  EXPECT_EQ(picture.at(3 * 64, 3 * 64), kRed);
  EXPECT_EQ(picture.at(3 * 64 - 1, 3 * 64).a, 0);
  EXPECT_EQ(picture.at(3 * 96, 3 * 96).a, 0);
}

TEST_F(SiteTest, TilesOfHigherZoomsShowTheirPart) {
  // The hole's north-west corner is in the middle of this tile.
  const Picture picture = picture_of(get("/tiles/rings/2/1/1.png"));
  EXPECT_EQ(picture.at(127, 127), kRed);
  EXPECT_EQ(picture.at(128, 128).a, 0);
  EXPECT_EQ(picture.at(127, 128), kRed);
  EXPECT_EQ(picture.at(191, 191).a, 0);
  EXPECT_EQ(picture.at(192, 192), kRed) << "the island";
}

TEST_F(SiteTest, TheFirstLayerIsTheLowest) {
  const Picture blue_over_red = picture_of(get("/tiles/rings,west/0/0/0.png"));
  EXPECT_EQ(blue_over_red.at(10, 10), kBlueHalf);
  EXPECT_EQ(blue_over_red.at(70, 100), (Rgba{127, 0, 128, 255}));
  EXPECT_EQ(blue_over_red.at(180, 100), kRed);
  const Picture red_over_blue = picture_of(get("/tiles/west,rings/0/0/0.png"));
  EXPECT_EQ(red_over_blue.at(70, 100), kRed);
}

TEST_F(SiteTest, StylesOfTheRequestAreDrawn) {
  const Picture picture =
      picture_of(get("/tiles/rings,west/0/0/0.png?rings.fill=lime&west.fill-opacity=0&"
                     "background=rgb(1,2,3)"));
  EXPECT_EQ(picture.at(70, 100), (Rgba{0, 255, 0, 255}));
  EXPECT_EQ(picture.at(10, 10), (Rgba{1, 2, 3, 255}));
}

TEST_F(SiteTest, WhereThereIsNoDataTheTileIsTransparent) {
  for (const char* target : {"/tiles/rings/5/0/0.png", "/tiles/west/6/0/0.png"}) {
    const auto response = get(target);
    ASSERT_EQ(response.status, 200);
    const Picture picture = picture_of(response);
    EXPECT_EQ(picture.width, 256);
    EXPECT_EQ(picture.at(128, 128).a, 0);
  }
}

TEST_F(SiteTest, TilesMayBeCachedAndTimed) {
  const auto response = get("/tiles/rings/0/0/0.png");
  EXPECT_EQ(response.header("Cache-Control"), "public, max-age=3600");
  EXPECT_EQ(response.header("Access-Control-Allow-Origin"), "*");
  EXPECT_THAT(std::string(response.header("Server-Timing")),
              ::testing::MatchesRegex("queue;dur=[0-9.]+, select;dur=[0-9.]+, draw;dur=[0-9.]+, "
                                      "read;dur=[0-9.]+, resolve;dur=[0-9.]+, "
                                      "compose;dur=[0-9.]+, encode;dur=[0-9.]+"));
}

TEST_F(SiteTest, ATileThatIsDrawnSaysWhatItCost) {
  const std::string cost(get("/tiles/rings/0/0/0.png").header("X-Tile-Cost"));
  EXPECT_GT(std::stoul(cost), 2u * 256 * 256 / 16);
  EXPECT_EQ(get("/tiles/rings/0/0/0.png").header("X-Tile-Cost"), "") << "a kept one costs nothing";
}

TEST(SiteLimitsTest, ATileThatCostsMoreThanOneMayIsRefusedInWords) {
  testing::SampleSite site(true, {}, {.tile_cost = 20'000});
  EXPECT_EQ(site.get("/tiles/rings/0/0/0.png").status, 200);
  const auto dear = site.get("/tiles/rings/0/0/0@4x.png?stroke=000&stroke-width=32");
  EXPECT_EQ(dear.status, 400);
  EXPECT_THAT(*dear.body, AllOf(HasSubstr("20000 units"), HasSubstr("simplify")));
}

TEST(SiteLimitsTest, WhatDearTilesCostIsLimitedAndCheapOnesAreNot) {
  testing::SampleSite site(true, {}, {.cost_per_second = 0.001, .cost_burst = 10'000});
  const std::string dear =
      "/tiles/rings,west,rings/0/0/0@4x.png?stroke=000&stroke-width=32&fill=00000";
  const auto drawn = site.get(dear + "1");
  EXPECT_EQ(drawn.status, 200);
  EXPECT_GT(std::stoul(std::string(drawn.header("X-Tile-Cost"))), defaults::kOrdinaryTile);
  const auto refused = site.get(dear + "2");
  EXPECT_EQ(refused.status, 429);
  EXPECT_EQ(refused.header("Retry-After"), "3600");
  EXPECT_EQ(site.get("/tiles/rings/0/0/0.png").status, 200);
  EXPECT_EQ(site.get("/legend/rings.png").status, 429) << "a document that is not kept";
}

TEST(SiteLimitsTest, PostedTablesCostWhatDocumentsCost) {
  testing::SampleSite site(true, {}, {.cost_per_second = 0.001, .cost_burst = 600'000});
  const auto post = [&site](int number, std::uint8_t client) {
    HttpRequest request{
        "POST", "/values", "maps.example", {}, "key,value\na," + std::to_string(number)};
    request.client.bytes[0] = client;
    return site.handle(request).status;
  };
  EXPECT_EQ(post(1, 1), 201);
  EXPECT_EQ(post(2, 1), 201);
  EXPECT_EQ(post(3, 1), 429) << "short tables keep the worker busy, too";
  EXPECT_EQ(post(3, 2), 201);
}

TEST(SiteLimitsTest, OneAddressMayPostOnlyAShareOfTheStyles) {
  testing::SampleSite site(true, {}, {.posted_styles = 100'000});
  const auto post = [&site](int number, std::uint8_t client) {
    HttpRequest request{"POST",
                        "/styles",
                        "maps.example",
                        {},
                        "{\"stroke-width\": " + std::to_string(number / 4.0) + "}"};
    request.client.bytes[0] = client;
    return site.handle(request).status;
  };
  int posted = 0;
  while (posted < 100 && post(posted, 1) == 201) ++posted;
  EXPECT_GT(posted, 10);
  EXPECT_LT(posted, 40);
  EXPECT_EQ(post(posted, 1), 429);
  EXPECT_EQ(post(0, 1), 201) << "it is there";
  EXPECT_EQ(post(posted, 2), 201);
}

TEST_F(SiteTest, ATileIsDrawnOnceAndThenKept) {
  const auto drawn = get("/tiles/rings/0/0/0.png");
  EXPECT_EQ(drawn.header("X-Cache"), "MISS");
  const auto kept = get("/tiles/rings/0/0/0.png?fill=f00");  // the same style in another notation
  EXPECT_EQ(kept.header("X-Cache"), "HIT");
  EXPECT_EQ(kept.body, drawn.body);
  EXPECT_EQ(kept.header("ETag"), drawn.header("ETag"));
  EXPECT_EQ(get("/tiles/rings/0/0/0.png?fill=f01").header("X-Cache"), "MISS");
}

// The meaning of a target is remembered only as long as the data stays the same.
TEST_F(SiteTest, WhatIsAskedForAgainFollowsTheData) {
  const std::string target = "/tiles/rings/0/0/0.png?fill=f02";
  const auto drawn = get(target);
  ASSERT_EQ(drawn.header("X-Cache"), "MISS");
  const std::string tag(drawn.header("ETag"));
  for (int i = 0; i < 3; ++i) {
    const auto kept = get(target);
    EXPECT_EQ(kept.header("X-Cache"), "HIT");
    EXPECT_EQ(kept.body, drawn.body);
    EXPECT_EQ(kept.header("ETag"), tag);
    EXPECT_EQ(get(target, tag).status, 304);
  }
  sample_.data().set(Dataset::load(layers_of_files({testing::fixture("west.geojson")})));
  EXPECT_EQ(get(target).status, 404);
  EXPECT_EQ(get(target, tag).status, 404);
  auto layers = layers_of_files({testing::fixture("west.geojson")});
  layers[0].name = "rings";
  sample_.data().set(Dataset::load(layers));
  const auto other = get(target);
  EXPECT_EQ(other.header("X-Cache"), "MISS");
  EXPECT_NE(other.header("ETag"), tag);
  EXPECT_NE(*other.body, *drawn.body);
}

// The name may refer to another style later.
TEST_F(SiteTest, TargetsThatNameAStyleAreNotRemembered) {
  EXPECT_TRUE(KnownTargets::may_be_known("/tiles/rings/0/0/0.png?fill=f02"));
  EXPECT_FALSE(KnownTargets::may_be_known("/tiles/rings/s/dark/0/0/0.png"));
  EXPECT_FALSE(KnownTargets::may_be_known("/tiles/rings/0/0/0.png?style=dark"));
  EXPECT_FALSE(KnownTargets::may_be_known("/tiles/rings/0/0/0.png?%73tyle=dark"));
  EXPECT_TRUE(KnownTargets::may_be_known("/tiles/rings/0/0/0.png?filter=name%3D%27a%20b%27"));
  EXPECT_FALSE(KnownTargets::may_be_known("/tiles/rings/0/0/0.png?fill=" + std::string(5000, 'f')));
}

TEST_F(SiteTest, EmptyAndFullTilesSaySo) {
  const auto hint = [this](const std::string& target) {
    const std::string first(get(target).header("OATiles-hint"));
    EXPECT_EQ(get(target).header("OATiles-hint"), first) << "from the cache";
    return first;
  };
  EXPECT_EQ(hint("/tiles/rings/0/0/0.png"), "");
  EXPECT_EQ(hint("/tiles/rings/5/0/0.png"), "empty");
  EXPECT_EQ(hint("/tiles/rings/5/9/9.png"), "full");
  EXPECT_EQ(hint("/tiles/rings,west/5/9/9.png"), "full");
  EXPECT_EQ(hint("/tiles/west,rings/5/31/31.png"), "empty");
  EXPECT_EQ(hint("/tiles/rings/5/9/9.png?debug=tile"), "");
  const auto translucent = get("/tiles/rings,west/5/9/9@2x.png?fill=red&west.fill-opacity=0.5");
  EXPECT_EQ(translucent.header("OATiles-hint"), "full");
  const Picture picture = picture_of(translucent);
  EXPECT_EQ(picture.width, 512);
  EXPECT_EQ(picture.at(0, 0), (Rgba{255, 0, 0, 255}));
  EXPECT_EQ(picture_of(get("/tiles/rings,west/5/9/9.png")).at(255, 255), (Rgba{127, 0, 128, 255}));
}

TEST_F(SiteTest, ATagThatTheClientHasIsNotModified) {
  const std::string tag(get("/tiles/rings/0/0/0.png").header("ETag"));
  ASSERT_THAT(tag, ::testing::MatchesRegex("\"[0-9a-f]+\""));
  const auto response = get("/tiles/rings/0/0/0.png?fill=red&_=1", tag);
  EXPECT_EQ(response.status, 304);
  EXPECT_EQ(response.body, nullptr);
  EXPECT_EQ(response.header("ETag"), tag);
  EXPECT_EQ(get("/tiles/rings/0/0/0.png?fill=blue", tag).status, 200);
}

TEST_F(SiteTest, StatusCodesSayWhatIsWrong) {
  EXPECT_EQ(status("/tiles/nosuch/0/0/0.png"), 404);
  EXPECT_EQ(status("/tiles/rings,nosuch/0/0/0.png"), 404);
  EXPECT_EQ(status("/tiles/nosuch.json"), 404);
  EXPECT_EQ(status("/tiles/rings/0/1/0.png"), 404);
  EXPECT_EQ(status("/tiles/rings/0/0/x.png"), 400);
  EXPECT_EQ(status("/tiles/rings/0/0/0.png?fill-opacity=2"), 400);
  EXPECT_EQ(status("/tiles/rings/0/0/0.png?fill=red&fill=red"), 400);
  EXPECT_EQ(status("/tiles/rings/0/0/0.png?%zz"), 400);
  EXPECT_EQ(status("/nosuch"), 404);
  EXPECT_EQ(status("/"), 404);
  EXPECT_EQ(status("/%00"), 400);
  EXPECT_EQ(status("/../../etc/passwd"), 404);
  EXPECT_EQ(status("nonsense"), 400);
}

TEST_F(SiteTest, ErrorsAreProblemsThatNameTheParameter) {
  const auto response = get("/tiles/rings/0/0/0.png?rings.fill=reddish");
  EXPECT_EQ(response.header("Content-Type"), "application/problem+json");
  EXPECT_EQ(response.header("Cache-Control"), "no-store");
  EXPECT_EQ(response.header("Access-Control-Allow-Origin"), "*");
  const auto json = nlohmann::json::parse(*response.body);
  EXPECT_EQ(json["status"], 400);
  EXPECT_EQ(json["parameter"], "rings.fill");
  EXPECT_EQ(json["value"], "reddish");
  EXPECT_THAT(json["takes"].get<std::string>(), HasSubstr("a colour"));
}

TEST_F(SiteTest, GeneralizationsThatAreNoneAreRefusedWithWhatIsAllowed) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"simplify=-1", "a number from 0 to 64"},
      {"simplify=nan", "a number from 0 to 64"},
      {"simplify=1e9", "a number from 0 to 64"},
      {"small=tiny", "one of drop, dust, keep"},
      {"topology=none", "one of fast, strict"},
      {"debug=everything", "some of faces, junctions, mesh, tile, vertices, separated by commas"}};
  for (const auto& [query, takes] : wrong) {
    const auto response = get("/tiles/rings/0/0/0.png?" + query);
    EXPECT_EQ(response.status, 400) << query;
    const auto json = nlohmann::json::parse(*response.body);
    EXPECT_EQ(json["parameter"], query.substr(0, query.find('='))) << query;
    EXPECT_EQ(json["value"], query.substr(query.find('=') + 1)) << query;
    EXPECT_EQ(json["takes"], takes) << query;
  }
}

TEST_F(SiteTest, ALargeToleranceLeavesOutWhatIsSmallerAndNoneLeavesOutNothing) {
  const Picture exact = picture_of(get("/tiles/rings/0/0/0.png?simplify=0"));
  EXPECT_EQ(exact.at(128, 100).a, 0) << "the hole";
  EXPECT_EQ(exact.at(128, 128), kRed) << "the island";
  // A square is removed as soon as half of its diagonal is within the tolerance: 23 pixels for the
  // island, 45 for the hole, 91 for the whole.
  const Picture coarse = picture_of(get("/tiles/rings/0/0/0.png?simplify=64&small=drop"));
  EXPECT_EQ(coarse.at(128, 100), kRed) << "the hole is filled";
  EXPECT_EQ(coarse.at(128, 128), kRed);
  EXPECT_EQ(coarse.at(63, 128).a, 0);
  EXPECT_EQ(coarse.at(64, 128), kRed);
  const Picture between = picture_of(get("/tiles/rings/0/0/0.png?simplify=32&small=drop"));
  EXPECT_EQ(between.at(128, 100).a, 0) << "the hole";
  EXPECT_EQ(between.at(128, 128).a, 0) << "the island has gone";
}

TEST_F(SiteTest, ThePolygonsThatAreLeftLookTheSameWithoutTheTopologyTest) {
  EXPECT_EQ(*get("/tiles/rings/0/0/0.png?topology=fast").body,
            *get("/tiles/rings/0/0/0.png?topology=strict").body);
}

TEST_F(SiteTest, ALayerIsDrawnWithoutTheTopologyTestOnlyWhereTheConfigurationAsksForIt) {
  const auto refused = get("/tiles/rings,west/0/0/0.png?topology=fast");
  EXPECT_EQ(refused.status, 400);
  EXPECT_THAT(*refused.body, AllOf(HasSubstr("west"), HasSubstr("fast_topology")));
  EXPECT_EQ(get("/tiles/rings,west/0/0/0.png?rings.topology=fast").status, 200);
  const auto layers = nlohmann::json::parse(*get("/catalog").body)["layers"];
  EXPECT_EQ(layers[0]["topologies"], nlohmann::json({"fast", "strict"}));
  EXPECT_EQ(layers[1]["topologies"], nlohmann::json({"strict"}));
}

TEST_F(SiteTest, TheCatalogListsWhatIsLocked) {
  auto layers = layers_of_files({testing::fixture("rings.geojson")});
  layers[0].locked = {ParameterId::simplify, ParameterId::fill_opacity};
  sample_.data().set(Dataset::load(layers));
  const auto listed = nlohmann::json::parse(*get("/catalog").body)["layers"];
  EXPECT_EQ(listed[0]["locked"], nlohmann::json({"simplify", "fill-opacity"}));
}

/// The opacities in the tile of zoom 0 with the speck, which covers a sixteenth of one pixel.
class SpeckTest : public SiteTest {
 protected:
  SpeckTest() {
    auto layers = layers_of_files({testing::fixture("speck.geojson")});
    layers[0].style = testing::style_of("fill=red");
    sample_.data().set(Dataset::load(layers));
  }
  Picture draw(const std::string& query) {
    return picture_of(get("/tiles/speck/0/0/0.png?" + query));
  }
  static int opacity(const Picture& picture) {
    int sum = 0;
    for (int row = 0; row < 256; ++row) {
      for (int column = 0; column < 256; ++column) sum += picture.at(column, row).a;
    }
    return sum;
  }
};

TEST_F(SpeckTest, DustKeepsItsAreaWhereItWas) {
  for (const char* query : {"", "small=dust", "simplify=0", "simplify=16"}) {
    const Picture picture = draw(query);
    EXPECT_NEAR(picture.at(128, 128).a, 16, 1) << query;
    EXPECT_EQ(opacity(picture), picture.at(128, 128).a) << query;
  }
}

TEST_F(SpeckTest, DropLeavesItOutUnlessEveryVertexIsDrawn) {
  EXPECT_EQ(opacity(draw("small=drop")), 0);
  EXPECT_NEAR(opacity(draw("small=drop&simplify=0")), 16, 1);
}

TEST_F(SpeckTest, KeepDrawsItAWholePixelLarge) {
  const Picture picture = draw("small=keep");
  EXPECT_GE(picture.at(128, 128).a, 250);
  EXPECT_NEAR(opacity(picture), 255, 5);
}

TEST_F(SiteTest, TheBorderOfATileIsDrawnOnRequest) {
  const Picture plain = picture_of(get("/tiles/rings/0/0/0.png"));
  const Picture marked = picture_of(get("/tiles/rings/0/0/0.png?debug=tile"));
  EXPECT_EQ(plain.at(0, 0).a, 0);
  for (const int i : {0, 1, 100, 200, 254, 255}) {
    EXPECT_EQ(marked.at(i, 255).a, 255) << i;
    EXPECT_EQ(marked.at(255, i).a, 255) << i;
    EXPECT_EQ(marked.at(0, i).a, 255) << i;
  }
  EXPECT_EQ(marked.at(100, 100), plain.at(100, 100));
  EXPECT_EQ(marked.at(80, 80), plain.at(80, 80));
  EXPECT_NE(*get("/tiles/rings/5/0/0.png?debug=tile").body,
            *get("/tiles/rings/5/0/1.png?debug=tile").body)
      << "each has its numbers";
}

TEST_F(SiteTest, VerticesAndTrapezoidsAreDrawnOnRequest) {
  const Picture vertices = picture_of(get("/tiles/rings/0/0/0.png?debug=vertices"));
  EXPECT_NE(vertices.at(64, 64), kRed);
  EXPECT_EQ(vertices.at(64, 64), vertices.at(192, 192)) << "two corners of the square";
  EXPECT_EQ(vertices.at(70, 128), kRed) << "away from the vertices";
  const Picture mesh = picture_of(get("/tiles/rings/0/0/0.png?debug=mesh&fill-opacity=0"));
  EXPECT_GT(mesh.at(64, 128).a, 0) << "the west side";
  EXPECT_GT(mesh.at(80, 96).a, 0) << "a trapezoid ends where the hole begins";
  EXPECT_EQ(mesh.at(80, 80).a, 0);
}

TEST_F(SiteTest, OtherMethodsAreRefusedAndOptionsAnswered) {
  for (const char* method : {"POST", "PUT", "DELETE", "PATCH", "TRACE", "FOO"}) {
    const auto response = sample_.handle({method, "/tiles/rings/0/0/0.png", "h", ""});
    EXPECT_EQ(response.status, 405) << method;
    EXPECT_EQ(response.header("Allow"), "GET, HEAD, OPTIONS");
  }
  const auto options = sample_.handle({"OPTIONS", "/tiles/rings/0/0/0.png", "h", ""});
  EXPECT_EQ(options.status, 204);
  EXPECT_EQ(options.body, nullptr);
  EXPECT_EQ(options.header("Access-Control-Allow-Methods"), "GET, HEAD, OPTIONS");
  EXPECT_EQ(options.header("Access-Control-Allow-Origin"), "*");
}

TEST_F(SiteTest, TileJsonDescribesTheLayersTogether) {
  const auto json = this->json("/tiles/rings,west.json?west.fill=teal&fill-opacity=.5&_=1");
  EXPECT_EQ(json["tilejson"], "3.0.0");
  EXPECT_EQ(json["name"], "Rings, west");
  EXPECT_EQ(json["attribution"], "drawn by hand");
  EXPECT_EQ(json["tiles"],
            nlohmann::json::array({"http://maps.example:8080/tiles/rings,west/{z}/{x}/{y}.png"
                                   "?fill-opacity=0.5&west.fill=008080ff"}));
  EXPECT_EQ(json["legend"],
            "http://maps.example:8080/legend/rings,west.png?fill-opacity=0.5&west.fill=008080ff");
  EXPECT_EQ(json["minzoom"], 0);
  EXPECT_EQ(json["maxzoom"], kMaxZoom);
  const auto bounds = json["bounds"].get<std::vector<double>>();
  ASSERT_EQ(bounds.size(), 4u);
  EXPECT_NEAR(bounds[0], -180, 1e-6);
  EXPECT_NEAR(bounds[1], -85.0511288, 1e-6);
  EXPECT_NEAR(bounds[2], 90, 1e-6);
  EXPECT_NEAR(bounds[3], 85.0511288, 1e-6);
  EXPECT_NEAR(json["center"][0], -45, 1e-6);
  EXPECT_NEAR(json["center"][1], 0, 1e-6);
  EXPECT_GE(json["center"][2], json["minzoom"]);
}

TEST_F(SiteTest, TileJsonSaysHowMuchGroundATileShowsAtEveryScale) {
  for (const std::string scale : {"", "@1x", "@2x", "@4x"}) {
    const auto json = this->json("/tiles/rings" + scale + ".json?fill=teal");
    EXPECT_EQ(json["tileSize"], 256) << scale;
    const std::string suffix = scale == "@1x" ? "" : scale;
    EXPECT_EQ(json["tiles"][0],
              "http://maps.example:8080/tiles/rings/{z}/{x}/{y}" + suffix + ".png?fill=008080ff");
    EXPECT_EQ(json["legend"],
              "http://maps.example:8080/legend/rings" + suffix + ".png?fill=008080ff");
  }
  EXPECT_EQ(picture_of(get("/tiles/rings/0/0/0@2x.png")).width, 512);
}

TEST(SiteStyleNameTest, DocumentsKeepTheNameOfTheStyle) {
  testing::SampleSite sample(true, {},
                             {.styles = {{"night", testing::style_of("fill=navy&stroke=white")}}});
  const auto json = [&sample](const std::string& target) {
    return nlohmann::json::parse(*sample.get(target).body);
  };
  const std::string root = "http://maps.example:8080";
  for (const char* target : {"/tiles/rings@2x.json?style=night&stroke-width=3&_=1",
                             "/tiles/rings/s/night@2x.json?stroke-width=3"}) {
    const auto tiles = json(target);
    EXPECT_EQ(tiles["tiles"][0], root + "/tiles/rings/s/night/{z}/{x}/{y}@2x.png?stroke-width=3");
    EXPECT_EQ(tiles["legend"], root + "/legend/rings@2x.png?style=night&stroke-width=3");
  }
  const std::string query = "?collections=rings,west&style=night&stroke-width=3";
  const auto tilesets = json("/ogc/map/tiles" + query);
  EXPECT_EQ(tilesets["tilesets"][0]["links"][0]["href"],
            root + "/ogc/map/tiles/WebMercatorQuad" + query);
  const auto tileset = json("/ogc/map/tiles/WebMercatorQuad" + query);
  const std::string item = tileset["links"][2]["href"];
  EXPECT_EQ(item, root + "/ogc/map/tiles/WebMercatorQuad/{tileMatrix}/{tileRow}/{tileCol}" + query);
  EXPECT_EQ(json("/tiles/rings.json?style=default&fill=red")["tiles"][0],
            root + "/tiles/rings/{z}/{x}/{y}.png?fill=ff0000ff");
  // These addresses lead to the requested style.
  EXPECT_EQ(*sample.get("/tiles/rings/s/night/0/0/0@2x.png?stroke-width=3").body,
            *sample.get("/tiles/rings/0/0/0@2x.png?fill=navy&stroke=white&stroke-width=3").body);
  EXPECT_EQ(*sample.get("/ogc/map/tiles/WebMercatorQuad/0/0/0" + query).body,
            *sample.get("/tiles/rings,west/0/0/0.png?fill=navy&stroke=white&stroke-width=3").body);
}

TEST_F(SiteTest, TileJsonOfOneLayerHasItsZooms) {
  const auto json = this->json("/tiles/west.json");
  EXPECT_EQ(json["maxzoom"], 5);
  EXPECT_EQ(json["tiles"][0], "http://maps.example:8080/tiles/west/{z}/{x}/{y}.png");
}

TEST_F(SiteTest, AHostThatIsNoneIsNotEchoed) {
  for (const char* host : {"", "evil/\"path", "a b", "<script>"}) {
    EXPECT_EQ(sample_.handle({"GET", "/tiles/rings.json", host, ""}).status, 400) << host;
  }
}

TEST(SitePublicUrlTest, GoesBeforeTheHost) {
  testing::SampleSite sample(true, {}, {.public_url = "https://cdn.example/maps"});
  const auto json = nlohmann::json::parse(*sample.get("/tiles/rings.json").body);
  EXPECT_EQ(json["tiles"][0], "https://cdn.example/maps/tiles/rings/{z}/{x}/{y}.png");
}

TEST(SiteAllowedHostsTest, AnswersOnlyToTheNamesThatAreAllowed) {
  testing::SampleSite sample(true, {}, {.allowed_hosts = {"maps.example", "*.cdn.example"}});
  const auto json = nlohmann::json::parse(*sample.get("/tiles/rings.json").body);
  EXPECT_EQ(json["tiles"][0], "http://maps.example:8080/tiles/rings/{z}/{x}/{y}.png");
  for (const char* target : {"/tiles/rings.json", "/catalog", "/ogc", "/wmts.xml"}) {
    const auto response = sample.handle({"GET", target, "evil.example", ""});
    EXPECT_EQ(response.status, 400) << target;
    EXPECT_THAT(*response.body, ::testing::ContainsRegex("(parameter\": |locator=)\"Host\""))
        << target;
    EXPECT_EQ(sample.handle({"GET", target, "a.cdn.example", ""}).status, 200) << target;
  }
}

TEST_F(SiteTest, TheCatalogListsLayersAndParameters) {
  const auto json = this->json("/catalog");
  ASSERT_EQ(json["layers"].size(), 2u);
  const auto& rings = json["layers"][0];
  EXPECT_EQ(rings["name"], "rings");
  EXPECT_EQ(rings["title"], "Rings");
  EXPECT_EQ(rings["attribution"], "drawn by hand");
  EXPECT_EQ(rings["features"], 1);
  EXPECT_EQ(rings["polygons"], 2);
  EXPECT_EQ(rings["rings"], 3);
  EXPECT_EQ(rings["vertices"], 12);
  EXPECT_EQ(rings["coverages"], 0);
  EXPECT_GT(rings["trapezoids"], 0);
  EXPECT_NEAR(rings["bounds"][0], -90, 1e-6);
  EXPECT_NEAR(rings["bounds"][3], 66.5132604, 1e-6);
  EXPECT_EQ(rings["fields"], nlohmann::json::parse(R"([{"name": "name", "type": "string"},
                                                       {"name": "rank", "type": "integer"}])"));
  EXPECT_EQ(json["renderer"], "software");
  EXPECT_EQ(json["generation"], sample_.data().get()->generation());
  EXPECT_EQ(json["parameters"].size(), style_parameters().size());
}

TEST(SiteViewerTest, TheCatalogSaysHowTheViewerBegins) {
  testing::SampleSite sample(true, {}, {.viewer = {"Atlas", "map=3/1/2"}});
  const auto json = nlohmann::json::parse(*sample.get("/catalog").body);
  EXPECT_EQ(json["viewer"], nlohmann::json::parse(R"({"title": "Atlas", "start": "map=3/1/2"})"));
}

TEST(SiteLayerWordsTest, LayersSayTheirGroupTheirDetailAndWhatTheirFeaturesAreCalledBy) {
  auto layers =
      layers_of_files({testing::fixture("rings.geojson"), testing::fixture("west.geojson")});
  layers[0].group = "World";
  layers[0].detail_zoom = 8;
  layers[1].detail_zoom = 18;
  layers[1].title_attribute = "no such attribute";
  testing::SampleSite sample(false);
  sample.data().set(Dataset::load(layers));
  const auto json = [&sample](const char* target) {
    return nlohmann::json::parse(*sample.get(target).body);
  };
  const auto catalog = json("/catalog");
  EXPECT_EQ(catalog["layers"][0]["group"], "World");
  EXPECT_EQ(catalog["layers"][0]["detail_zoom"], 8);
  EXPECT_EQ(catalog["layers"][0]["title_attribute"], "name") << "found by its name";
  EXPECT_FALSE(catalog["layers"][1].contains("group"));
  EXPECT_FALSE(catalog["layers"][1].contains("title_attribute"));
  EXPECT_EQ(json("/tiles/west.json")["detail_zoom"], 18);
  EXPECT_EQ(json("/tiles/west,rings.json")["detail_zoom"], 8) << "up to there both are true";
  layers[0].title_attribute = "rank";
  sample.data().set(Dataset::load(layers));
  EXPECT_EQ(json("/catalog")["layers"][0]["title_attribute"], "rank");
  EXPECT_EQ(json("/identify/rings/-80,0")["features"][0]["title"], "1");
}

TEST_F(SiteTest, DocumentsAreNotSentAgainToWhoHasThem) {
  for (const char* target : {"/catalog", "/tiles/rings.json"}) {
    const std::string tag(get(target).header("ETag"));
    EXPECT_EQ(get(target, tag).status, 304);
    EXPECT_EQ(get(target, "\"other\"").status, 200);
  }
}

TEST_F(SiteTest, TextIsSentCompressedToWhoTakesThat) {
  for (const char* target :
       {"/catalog", "/wmts.xml", "/ogc/api", "/ogc/tileMatrixSets/WebMercatorQuad"}) {
    const auto plain = get(target);
    ASSERT_GT(plain.body->size(), kLeastToCompress) << target;
    EXPECT_EQ(plain.header("Content-Encoding"), "");
    EXPECT_EQ(plain.header("Vary"), "Accept-Encoding") << target;
    for (int i = 0; i < 2; ++i) {  // first made, then from the cache
      const auto gzip = get_compressed(target, "gzip");
      EXPECT_EQ(gzip.status, 200) << target;
      EXPECT_EQ(gzip.header("Content-Encoding"), "gzip") << target;
      EXPECT_EQ(gzip.header("Vary"), "Accept-Encoding") << target;
      EXPECT_EQ(gzip.header("Content-Type"), plain.header("Content-Type")) << target;
      EXPECT_TRUE(gzip.body->starts_with("\x1f\x8b")) << target;
      EXPECT_LT(2 * gzip.body->size(), plain.body->size()) << target;
    }
  }
}

TEST_F(SiteTest, ATagIsOfOneEncodingAlone) {
  const std::string plain(get("/catalog").header("ETag"));
  const std::string gzip(get_compressed("/catalog", "gzip").header("ETag"));
  EXPECT_NE(plain, gzip);
  EXPECT_EQ(get_compressed("/catalog", "gzip", gzip).status, 304);
  EXPECT_EQ(get_compressed("/catalog", "gzip", gzip).header("Vary"), "Accept-Encoding");
  EXPECT_EQ(get_compressed("/catalog", "gzip", plain).status, 200);
  EXPECT_EQ(get("/catalog", gzip).status, 200);
  EXPECT_EQ(get("/catalog", plain).status, 304);
}

TEST_F(SiteTest, WhatIsShortOrAPictureIsSentAsItIs) {
  for (const char* target : {"/styles", "/tiles/rings/0/0/0.png", "/legend/rings.png", "/health"}) {
    const auto response = get_compressed(target, "gzip, br");
    EXPECT_EQ(response.status, 200) << target;
    EXPECT_EQ(response.header("Content-Encoding"), "") << target;
    EXPECT_EQ(response.header("Vary"), "") << target;
  }
}

TEST(SiteLoadingTest, TellsWhichLayersAreReadAndHowFar) {
  LayersToRead layers;
  testing::SampleSite sample(false, {}, {.loading = [&layers] { return layers.get(); }});
  const auto ready = [&sample] { return nlohmann::json::parse(*sample.get("/ready").body); };
  EXPECT_EQ(ready()["layers"], nlohmann::json::array());
  layers.begin({{"a", "A", 0}, {"b", "B", 0}, {"c", "C", 0}});
  layers.show(0, 0.4567);
  layers.show(1, -1);
  layers.show(2, 1);
  EXPECT_EQ(sample.get("/ready").header("Content-Type"), "application/json");
  EXPECT_EQ(ready()["status"], "loading");
  EXPECT_EQ(ready()["layers"], nlohmann::json::parse(R"([
      {"name": "a", "title": "A", "percent": 45}, {"name": "b", "title": "B", "percent": null},
      {"name": "c", "title": "C", "percent": 99}])"));
  layers.finish(2);
  EXPECT_EQ(ready()["layers"][2]["percent"], 100);
}

TEST(SiteLoadingTest, TheViewerIsThereBeforeTheLayersAre) {
  constexpr BuiltInFile kFiles[] = {{"/index.html", "<html>", "", ""}};
  testing::SampleSite sample(/*is_loaded=*/false, StaticFiles(kFiles));
  EXPECT_EQ(sample.get("/").status, 200);
  EXPECT_EQ(sample.get("/catalog").status, 503);
}

TEST(SiteLoadingTest, IsHealthyButNotReadyUntilTheDataIsThere) {
  testing::SampleSite sample(/*is_loaded=*/false);
  EXPECT_EQ(sample.get("/health").status, 200);
  for (const char* target : {"/ready", "/catalog", "/tiles/rings.json", "/tiles/rings/0/0/0.png"}) {
    const auto response = sample.get(target);
    EXPECT_EQ(response.status, 503) << target;
    EXPECT_EQ(response.header("Retry-After"), "1");
  }
  EXPECT_EQ(sample.get("/tiles/rings/0/0/x.png").status, 400);
  sample.data().set(testing::sample_dataset());
  for (const char* target : {"/health", "/ready", "/catalog", "/tiles/rings/0/0/0.png"}) {
    EXPECT_EQ(sample.get(target).status, 200) << target;
  }
}

TEST(SiteFilesTest, ServesTheViewer) {
  const std::string root = ::testing::TempDir() + "/site_files_test";
  std::filesystem::create_directories(root);
  std::ofstream(root + "/index.html") << "<p>map</p>";
  std::ofstream(root + "/a b.css") << "p {}";
  testing::SampleSite sample(true, StaticFiles(root));
  std::filesystem::remove_all(root);
  const auto index = sample.get("/?layers=rings");
  EXPECT_EQ(index.status, 200);
  EXPECT_EQ(*index.body, "<p>map</p>");
  EXPECT_EQ(index.header("Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(sample.get("/", std::string(index.header("ETag"))).status, 304);
  EXPECT_EQ(*sample.get("/a%20b.css").body, "p {}");
  EXPECT_EQ(sample.get("/..%2f..%2fetc/passwd").status, 404);
}

TEST(SiteFilesTest, WithoutAViewerTheRootSaysWhy) {
  testing::SampleSite sample(true, {}, {.why_no_viewer = "It was left out."});
  const auto response = sample.get("/");
  EXPECT_EQ(response.status, 404);
  EXPECT_THAT(*response.body, ::testing::HasSubstr("It was left out. The layers are at /catalog."));
}

TEST(SiteFilesTest, TheViewerIsSentCompressedToWhoTakesThat) {
  constexpr BuiltInFile kFiles[] = {{"/index.html", "long text", "short", "br"}};
  testing::SampleSite sample(false, StaticFiles(kFiles));
  const auto get = [&sample](const char* method, const char* accept_encoding) {
    HttpRequest request{method, "/", "maps.example", "", {}};
    request.accept_encoding = accept_encoding;
    return sample.handle(request);
  };
  std::set<std::string> tags;
  for (const auto& [accepted, encoding, bytes] :
       {std::tuple("", "", "long text"), std::tuple("gzip", "gzip", "short"),
        std::tuple("gzip, br", "br", "br")}) {
    for (const char* method : {"GET", "HEAD"}) {
      const auto response = get(method, accepted);
      EXPECT_EQ(response.status, 200);
      EXPECT_EQ(response.header("Content-Encoding"), encoding);
      EXPECT_EQ(response.header("Vary"), "Accept-Encoding");
      EXPECT_EQ(*response.body, bytes);
      tags.insert(std::string(response.header("ETag")));
    }
  }
  EXPECT_EQ(tags.size(), 3u);
}

}  // namespace
}  // namespace trapeze
