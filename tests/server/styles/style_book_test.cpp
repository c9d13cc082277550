#include "server/styles/style_book.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "server/base/defaults.h"
#include "server/styles/filter.h"
#include "server/styles/style_document.h"
#include "tests/sanitized.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::HasSubstr;

/// The style that a query gives for the layers "land" and "water".
std::string style_text(const StyleBook& book, std::vector<QueryPair> query) {
  static const std::vector<std::string> layers = {"land", "water"};
  const auto styled = book.read(std::move(query));
  if (!styled) return "problem: " + styled.problem().detail;
  const auto style = styled->style_for(layers);
  return style ? style->canonical_text() : "problem: " + style.problem().detail;
}

StyleQuery layered_style(const std::string& json) {
  return *parse_style_document(json);
}

TEST(StyleBookTest, AStyleFillsInWhatTheQueryDoesNotSet) {
  const StyleBook book({{"night", testing::style_of("fill=000080&stroke=ffffff")}});
  EXPECT_EQ(style_text(book, {{"style", "night"}}), "fill=000080ff&stroke=ffffffff");
  EXPECT_EQ(style_text(book, {{"stroke", "red"}, {"style", "night"}, {"_", "1"}}),
            "fill=000080ff&stroke=ff0000ff");
  EXPECT_EQ(style_text(book, {{"style", "default"}, {"fill", "red"}}), "fill=ff0000ff");
  EXPECT_EQ(style_text(book, {{"fill", "red"}}), "fill=ff0000ff");
}

TEST(StyleBookTest, AStyleSaysMoreOfOneLayerThanTheQueryOfAll) {
  const StyleBook book(
      {{"night",
        layered_style(R"({"layers": {"water": {"fill": "navy"}, "sky": {"fill": "red"}}})")}});
  EXPECT_EQ(style_text(book, {{"style", "night"}, {"fill", "lime"}}),
            "fill=00ff00ff&water.fill=000080ff");
  EXPECT_EQ(style_text(book, {{"style", "night"}, {"water.fill", "lime"}}), "water.fill=00ff00ff");
}

TEST(StyleBookTest, RulesForClassesGoTogether) {
  const StyleBook book({{"a", testing::style_of("color-by=kind&classes=x:red&fill=lime")}});
  EXPECT_EQ(style_text(book, {{"style", "a"}, {"color-by", "people"}, {"breaks", "1"}}),
            "breaks=1&color-by=people&fill=00ff00ff");
  EXPECT_EQ(style_text(book, {{"style", "a"}, {"water.color-by", "people"}}),
            "classes=x%3Aff0000ff&color-by=kind&fill=00ff00ff&water.color-by=people");
}

TEST(StyleBookTest, UnknownStylesAreAProblem) {
  const StyleBook book({{"night", testing::style_of("fill=navy")}});
  const auto answer = book.read({{"style", "day"}});
  const auto& problem = answer.problem();
  EXPECT_EQ(problem.status, 400);
  EXPECT_EQ(problem.parameter, "style");
  EXPECT_THAT(problem.takes, HasSubstr("night"));
  EXPECT_FALSE(book.read({{"style", "night"}, {"style", "night"}}));
}

TEST(StyleBookTest, EqualStylesHaveOneIdEverywhere) {
  StyleBook one;
  StyleBook two;
  const std::string id = *one.post(testing::style_of("fill=red&stroke=f00"));
  EXPECT_EQ(*two.post(testing::style_of("stroke=red&fill=ff0000ff")), id);
  EXPECT_NE(*two.post(testing::style_of("fill=red")), id);
  EXPECT_TRUE(is_url_name(id));
  ASSERT_NE(one.find(id), nullptr);
  EXPECT_EQ(one.find(id)->canonical_text(), "fill=ff0000ff&stroke=ff0000ff");
  EXPECT_EQ(one.find("0123456789abcdef"), nullptr);
}

TEST(StyleBookTest, PostedStylesKeepToTheirBudget) {
  StyleBook book({}, 4096);
  const std::string first = *book.post(testing::style_of("stroke-width=32"));
  std::string last;
  for (int i = 1; i < 100; ++i) {
    last = *book.post(testing::style_of("stroke-width=" + std::to_string(i / 4.0)));
    EXPECT_LE(book.memory(), 4096u);
  }
  EXPECT_EQ(book.find(first), nullptr);
  EXPECT_NE(book.find(last), nullptr);
}

TEST(StyleBookTest, WithoutABudgetNothingIsKept) {
  StyleBook book({}, 0);
  const auto answer = book.post(testing::style_of("fill=red"));
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.problem().status, 403);
  EXPECT_EQ(book.memory(), 0u);
}

TEST(StyleBookTest, ALongStyleIsRefused) {
  const std::string half(StyleBook::kMaxStyleLength / 2, 'x');
  const auto style = parse_style_document(R"({"color-by": "a", "classes": {")" + half +
                                          R"(": "red", ")" + half + R"(y": "red"}})");
  ASSERT_TRUE(style);
  const auto answer = StyleBook().post(*style);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.problem().status, 400);
}

/// A document that sets every long parameter in full for each of the layers.
nlohmann::json full_style(int layers) {
  nlohmann::json document;
  for (int layer = 0; layer < layers; ++layer) {
    nlohmann::json style = {{"fill", "#123456"}, {"stroke", "white"}, {"color-by", "kind of use"}};
    for (int i = 0; i < 64; ++i) {
      style["classes"]["use of the land, number " + std::to_string(i)] = "#abcdef";
    }
    for (std::int64_t i = 0; i < 256; ++i) {
      style["ids"].push_back(std::numeric_limits<std::int64_t>::max() - i);
      style["highlight"].push_back(std::numeric_limits<std::int64_t>::min() + i);
    }
    std::string filter = "\"kind of use\" <> 'x";
    filter.append(kMaxFilterLength - filter.size() - 1, '%');
    style["filter"] = filter + "'";
    document["layers"]["layer_with_a_name_" + std::to_string(layer)] = style;
  }
  return document;
}

TEST(StyleBookTest, AFullStyleOfThirtyLayersCanBePosted) {
  testing::SampleSite site;
  const std::string body = full_style(30).dump();
  EXPECT_GT(body.size(), 300'000u);
  EXPECT_LT(body.size(), std::size_t{defaults::kBodyBytes});
  const auto response = site.handle({"POST", "/styles", "maps.example", {}, body});
  ASSERT_EQ(response.status, 201) << response.body->substr(0, 500);
  const std::string id = nlohmann::json::parse(*response.body)["id"];
  EXPECT_EQ(site.get("/tiles/rings/s/" + id + "/0/0/0.png").status, 200);
  const auto again =
      site.handle({"POST", "/styles", "maps.example", {}, *site.get("/styles/" + id).body});
  EXPECT_EQ(nlohmann::json::parse(*again.body)["id"], id) << "it is read back as the same";
}

TEST(StyleBookTest, AStyleLargerThanTheShareOfAnAddressIsRefusedWithWords) {
  testing::SampleSite site(true, {}, {.posted_styles = std::size_t{1} << 20});
  const auto response = site.handle({"POST", "/styles", "maps.example", {}, full_style(10).dump()});
  EXPECT_EQ(response.status, 403);
  EXPECT_THAT(*response.body, HasSubstr("An eighth of the 1 MB"));
}

TEST(StyleDocumentTest, MoreMembersThanAnyStyleHasAreRefusedAtOnce) {
  std::string many = "{";
  for (int i = 0; i < 90'000; ++i) many += "\"a" + std::to_string(i) + "\": 1, ";
  std::string deep(500'000, '[');
  for (const std::string& text : {many + "\"b\": 1}", many, deep, "{\"a\": " + deep}) {
    const auto begin = std::chrono::steady_clock::now();
    const auto style = parse_style_document(text);
    ASSERT_FALSE(style);
    EXPECT_THAT(style.problem().detail, HasSubstr("at most 4096 members"));
    if (!testing::kIsSanitized) {
      EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
    }
  }
}

std::string canonical_document(std::string_view json) {
  const auto style = parse_style_document(json);
  if (!style) return "problem: " + style.problem().detail;
  return style->canonical_text();
}

TEST(StyleDocumentTest, TheOpacityOfMapLibreIsAlsoThatOfOutlines) {
  EXPECT_EQ(
      canonical_document(
          R"({"paint": {"fill-color": "red", "fill-opacity": 0.5, "fill-outline-color": "blue"}})"),
      "fill=ff0000ff&fill-opacity=0.5&stroke=0000ffff&stroke-opacity=0.5");
  EXPECT_EQ(canonical_document(R"({"fill-opacity": 0.5, "stroke": "blue"})"),
            "fill-opacity=0.5&stroke=0000ffff");
}

TEST(StyleDocumentTest, AMemberGivenTwiceIsAProblem) {
  for (const char* json :
       {R"({"fill": "red", "fill": "blue"})",
        R"({"layers": {"a": {"fill": "red", "fill": "red"}}})",
        R"({"color-by": "A3", "classes": {"FRA": "red", "DEU": "lime", "FRA": "blue"}})"}) {
    EXPECT_THAT(canonical_document(json), HasSubstr("more than once")) << json;
  }
  EXPECT_EQ(canonical_document(R"({"layers": {"a": {"fill": "red"}, "b": {"fill": "red"}}})"),
            "a.fill=ff0000ff&b.fill=ff0000ff");
}

TEST(StyleDocumentTest, HasTheParametersByTheirNames) {
  EXPECT_EQ(
      canonical_document(R"({"fill": "#ff0000", "stroke-width": 2, "stroke-dasharray": [4, 2.5]})"),
      "fill=ff0000ff&stroke-dasharray=4%2C2.5&stroke-width=2");
  EXPECT_EQ(canonical_document(R"({"layers": {"water": {"fill": "navy"}}, "land.fill": "lime"})"),
            "land.fill=00ff00ff&water.fill=000080ff");
  EXPECT_EQ(canonical_document(R"({"color-by": "A3", "classes": {"it's": "red", "*": "blue"}})"),
            "classes=%27it%27%27s%27%3Aff0000ff%2C%2A%3A0000ffff&color-by=A3");
  EXPECT_EQ(canonical_document("{}"), "");
}

TEST(StyleDocumentTest, UnderstandsThePaintOfMapLibre) {
  EXPECT_EQ(canonical_document(R"({"id": "land", "type": "fill", "source": "x", "source-layer": "y",
                          "paint": {"fill-color": "#0f0", "fill-opacity": 0.5,
                                    "fill-outline-color": "black", "fill-antialias": true}})"),
            "fill=00ff00ff&fill-opacity=0.5&stroke=000000ff&stroke-opacity=0.5");
}

TEST(StyleDocumentTest, NothingIsLeftOutInSilence) {
  for (const auto& [json, says] : std::vector<std::pair<std::string, std::string>>{
           {"", "not JSON"},
           {"[1]", "JSON object"},
           {R"({"fil": 1})", "does not know \"fil\"; did you mean \"fill\"?"},
           {R"({"fill": true})", "fill takes a colour"},
           {R"({"fill": {"a": 1}})", "fill takes a colour"},
           {R"({"fill": "reddish"})", "fill takes a colour"},
           {R"({"type": "line"})", "does not know \"type\""},
           {R"({"paint": {"fill-pattern": "x"}})", "does not know \"fill-pattern\""},
           {R"({"paint": {"fill-color": ["get", "c"]}})", "fill takes a colour"},
           {R"({"style": "night"})", "does not know \"style\""},
           {R"({"layers": {"a b": {"fill": "red"}}})", "cannot name a layer"},
           {R"({"layers": {"a": 1}})", "needs an object"},
           {R"({"ids": 18446744073709551615})", "ids takes 1 to"},
           {R"({"color-by": "a\u0001"})", "color-by takes the name of an attribute"},
           {R"({"classes": {"a\nb": "red"}})", "classes takes 1 to"},
           {R"({"filter": "a = 'b\t'"})", "at byte 7 there is a control character"},
           {R"({"water.background": "red"})", "for one layer"},
           {R"({"fill": "red", "paint": {"fill-color": "blue"}})", "more than once"}}) {
    EXPECT_THAT(canonical_document(json), HasSubstr(says)) << json;
  }
}

TEST(StyleDocumentTest, IsReadBackAsTheSameStyle) {
  for (const std::string query :
       {"fill=red&opacity=0.25", "stroke-dasharray=1,2&ids=3,1&filter=a%3D'b'",
        "color-by=k&classes='x,y':red,null:blue,*:lime", "breaks=1,2.5&ramp=Reds&color-by=k"}) {
    const StyleQuery style = testing::style_of(query);
    EXPECT_EQ(canonical_document(style_document(style)), style.canonical_text());
  }
}

SiteOptions with_night() {
  SiteOptions options;
  options.styles.emplace("night", testing::style_of("fill=navy&background=black"));
  return options;
}

class StyleRoutesTest : public ::testing::Test {
 protected:
  HttpResponse post(const std::string& body) {
    return site_.handle({"POST", "/styles", "maps.example:8080", {}, body});
  }
  static std::string id_of(const HttpResponse& response) {
    const std::size_t begin = response.body->find("\"id\": \"") + 7;
    return response.body->substr(begin, response.body->find('"', begin) - begin);
  }

  testing::SampleSite site_{true, {}, with_night()};
};

TEST_F(StyleRoutesTest, APostedStyleIsServedByItsId) {
  const HttpResponse posted = post(R"({"fill": "lime"})");
  ASSERT_EQ(posted.status, 201);
  const std::string id = id_of(posted);
  EXPECT_EQ(posted.header("Location"), "http://maps.example:8080/styles/" + id);
  EXPECT_EQ(id_of(post(R"({"fill": "#00ff00"})")), id);
  const HttpResponse direct = site_.get("/tiles/rings/0/0/0.png?fill=lime");
  const HttpResponse by_path = site_.get("/tiles/rings/s/" + id + "/0/0/0.png");
  const HttpResponse by_query = site_.get("/tiles/rings/0/0/0.png?style=" + id);
  ASSERT_EQ(direct.status, 200);
  EXPECT_EQ(by_path.header("ETag"), direct.header("ETag"));
  EXPECT_EQ(by_query.header("ETag"), direct.header("ETag"));
  EXPECT_EQ(*by_path.body, *direct.body);
  EXPECT_EQ(site_.get("/tiles/rings/s/" + id + "/0/0/0.png?fill=red").header("ETag"),
            site_.get("/tiles/rings/0/0/0.png?fill=red").header("ETag"));
  EXPECT_THAT(*site_.get("/styles/" + id).body, HasSubstr("00ff00ff"));
}

TEST_F(StyleRoutesTest, NamedStylesAreServedAndListed) {
  EXPECT_EQ(site_.get("/tiles/rings/0/0/0.png?style=night").header("ETag"),
            site_.get("/tiles/rings/0/0/0.png?fill=navy&background=black").header("ETag"));
  EXPECT_EQ(site_.get("/tiles/rings/s/default/0/0/0.png").header("ETag"),
            site_.get("/tiles/rings/0/0/0.png").header("ETag"));
  EXPECT_THAT(*site_.get("/styles").body, HasSubstr("night"));
  EXPECT_THAT(*site_.get("/tiles/rings.json?style=night").body,
              HasSubstr("/tiles/rings/s/night/{z}"));
  EXPECT_EQ(site_.get("/legend/rings.json?style=night").status, 200);
  EXPECT_THAT(*site_.get("/wmts.xml").body, HasSubstr("<ows:Identifier>night</ows:Identifier>"));
  const std::string get_tile =
      "/wmts?service=WMTS&request=GetTile&version=1.0.0&layer=rings&format=image/png"
      "&tilematrixset=WebMercatorQuad&tilematrix=0&tilerow=0&tilecol=0";
  EXPECT_EQ(site_.get(get_tile + "&STYLE=night").header("ETag"),
            site_.get("/tiles/rings/0/0/0.png?style=night").header("ETag"));
  EXPECT_EQ(site_.get(get_tile + "&style=default").header("ETag"),
            site_.get("/tiles/rings/0/0/0.png").header("ETag"));
}

TEST_F(StyleRoutesTest, WhatIsWrongIsSaid) {
  EXPECT_EQ(post("{").status, 400);
  EXPECT_EQ(post(R"({"fill": 3})").status, 400);
  EXPECT_EQ(site_.get("/styles/nosuch").status, 404);
  EXPECT_EQ(site_.get("/tiles/rings/s/nosuch/0/0/0.png").status, 404);
  EXPECT_EQ(site_.get("/tiles/rings/0/0/0.png?style=nosuch").status, 400);
  EXPECT_EQ(site_.get("/legend/rings.png?style=nosuch").status, 400);
  EXPECT_EQ(site_.get("/tiles/rings/s/night/0/0/0.png?style=night").status, 400);
  EXPECT_EQ(site_.handle({"POST", "/catalog", "maps.example:8080", {}, "{}"}).status, 405);
  EXPECT_EQ(site_.handle({"PUT", "/styles", "maps.example:8080", {}, "{}"}).header("Allow"),
            "GET, HEAD, OPTIONS, POST");
  EXPECT_EQ(site_.handle({"OPTIONS", "/styles", "maps.example:8080", {}, {}})
                .header("Access-Control-Allow-Methods"),
            "GET, HEAD, OPTIONS, POST");
}

}  // namespace
}  // namespace trapeze
