#include "server/styles/style_parameters.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

namespace trapeze {
namespace {

const std::vector<std::string> kLayers = {"roads", "lakes"};

Result<StyleQuery> parse(std::string_view query) {
  return StyleQuery::parse(decode_query(query).value(), kLayers);
}

std::string canonical_query(std::string_view query) {
  const auto parsed = parse(query);
  if (!parsed) return "problem: " + parsed.problem().detail;
  return parsed->canonical_text();
}

Problem problem_of(std::string_view query) {
  const auto parsed = parse(query);
  if (!parsed) return parsed.problem();
  ADD_FAILURE() << query << " was taken";
  return {0, ""};
}

TEST(StyleParametersTest, EqualStylesHaveEqualText) {
  const std::string text = canonical_query("background=white&fill=red");
  for (const char* query : {"fill=red&background=white", "fill=f00&background=fff",
                            "fill=FF0000&background=WHITE", "fill=%23ff0000ff&background=ffffffff",
                            "background=rgb(255,255,255)&&fill=rgba(255,+0,+0,+1)",
                            "_=1&fill=red&background=white&_=2"}) {
    EXPECT_EQ(canonical_query(query), text) << query;
  }
  EXPECT_EQ(canonical_query("fill-opacity=0.50"), canonical_query("fill-opacity=5e-1"));
  EXPECT_EQ(canonical_query("fill-opacity=-0"), canonical_query("fill-opacity=0"));
}

TEST(StyleParametersTest, DifferentStylesHaveDifferentText) {
  EXPECT_NE(canonical_query("fill=red"), canonical_query("fill=fe0000"));
  EXPECT_NE(canonical_query("fill=red"), canonical_query("background=red"));
  EXPECT_NE(canonical_query("fill=red"), canonical_query("roads.fill=red"));
  EXPECT_NE(canonical_query("fill-opacity=0.5"), canonical_query("fill-opacity=0.51"));
}

TEST(StyleParametersTest, CanonicalTextReadsBackAsItself) {
  const std::string text =
      canonical_query("lakes.fill=teal&fill-opacity=0.1&roads.fill-opacity=.25");
  EXPECT_EQ(canonical_query(text), text);
  EXPECT_EQ(text, "fill-opacity=0.1&lakes.fill=008080ff&roads.fill-opacity=0.25");
}

TEST(StyleParametersTest, ANameThatMeansNothingIsAProblemWithTheNearestThatDoes) {
  for (const auto& [query, nearest] : std::vector<std::pair<const char*, const char*>>{
           {"fil=red", "\"fill\"?"},
           {"FILL=red", "\"fill\"?"},
           {"fill%20=red", "\"fill\"?"},
           {"lake.fill=red", "\"lakes.fill\"?"},
           {"roads.fil=red", "\"roads.fill\"?"},
           {"roads.background=red", "background applies to the whole tile"},
           {"sea.opacity=1", "the request has no layer \"sea\""},
           {"=red", "\"\"."},
           {"v=7", "\"v\"."}}) {
    const Problem problem = problem_of(query);
    EXPECT_EQ(problem.status, 400) << query;
    EXPECT_NE(problem.detail.find(nearest), std::string::npos) << problem.detail;
  }
}

TEST(StyleParametersTest, OneNameIsFreeForAnyValue) {
  EXPECT_EQ(canonical_query("_=1732000000&fill=red&_=2"), canonical_query("fill=red"));
  EXPECT_FALSE(parse("_fill=red"));
}

TEST(StyleParametersTest, NamesThatAreReadElsewhereArePassedOver) {
  const std::vector<QueryPair> pairs = {{"z", "7"}, {"fill", "red"}};
  constexpr std::array<std::string_view, 1> kOthers = {"z"};
  EXPECT_TRUE(StyleQuery::parse(pairs, kLayers, kOthers));
  EXPECT_FALSE(StyleQuery::parse(pairs, kLayers));
}

TEST(StyleParametersTest, NamesThatAreReadElsewhereComeOnce) {
  const std::vector<QueryPair> pairs = {{"z", "7"}, {"fill", "red"}, {"z", "7"}};
  constexpr std::array<std::string_view, 1> kOthers = {"z"};
  const auto parsed = StyleQuery::parse(pairs, kLayers, kOthers);
  ASSERT_FALSE(parsed);
  EXPECT_EQ(parsed.problem().status, 400);
  EXPECT_EQ(parsed.problem().parameter, "z");
}

TEST(StyleParametersTest, ALayersOwnSettingGoesBeforeTheOneForAll) {
  const auto parsed = parse("fill=red&lakes.fill=blue");
  const auto& query = *parsed;
  EXPECT_EQ(query.value_for("roads", ParameterId::fill), ParameterValue(Rgba{255, 0, 0, 255}));
  EXPECT_EQ(query.value_for("lakes", ParameterId::fill), ParameterValue(Rgba{0, 0, 255, 255}));
  EXPECT_EQ(query.value_for("lakes", ParameterId::fill_opacity), std::nullopt);
}

TEST(StyleParametersTest, WrongValuesAreProblemsThatNameTheParameter) {
  for (const char* value : {"", "-1", "-0.001", "1.001", "2", "1e9", "nan", "inf", "-inf", "0x1",
                            "0.5 ", "%200.5", "half", "0,5", "1e999"}) {
    const Problem problem = problem_of(std::string("roads.fill-opacity=") + value);
    EXPECT_EQ(problem.status, 400);
    EXPECT_EQ(problem.parameter, "roads.fill-opacity");
    EXPECT_EQ(problem.takes, "a number from 0 to 1");
  }
  for (const char* value : {"", "f", "ff", "fffff", "nocolour", "rgb(1,2)", "%3Cscript%3E"}) {
    EXPECT_EQ(problem_of(std::string("fill=") + value).parameter, "fill") << value;
  }
}

TEST(StyleParametersTest, AParameterGivenTwiceIsAProblem) {
  EXPECT_EQ(problem_of("fill=red&fill=red").parameter, "fill");
  EXPECT_EQ(problem_of("lakes.fill=red&fill=blue&lakes.fill=red").parameter, "lakes.fill");
}

TEST(StyleParametersTest, TheSameToleranceHasOneText) {
  EXPECT_EQ(canonical_query("simplify=0.50"), "simplify=0.5");
  EXPECT_EQ(canonical_query("simplify=5e-1"), "simplify=0.5");
  EXPECT_EQ(canonical_query("simplify=-0"), "simplify=0");
  EXPECT_EQ(canonical_query("simplify=64"), "simplify=64");
  EXPECT_NE(canonical_query("simplify=0"), canonical_query(""));
}

TEST(StyleParametersTest, ListsOfWordsHaveOneOrderAndNoRepetition) {
  const std::string all = canonical_query("debug=mesh,tile,vertices");
  EXPECT_EQ(canonical_query("debug=vertices,mesh,tile"), all);
  EXPECT_EQ(canonical_query("debug=tile,vertices,mesh,tile,tile"), all);
  EXPECT_EQ(canonical_query(all), all);
  EXPECT_EQ(canonical_query("debug=tile"), "debug=tile");
}

TEST(StyleParametersTest, GeneralizationIsSetForAllLayersOrForOne) {
  const std::string text =
      canonical_query("roads.topology=fast&small=drop&lakes.simplify=2&lakes.small=keep");
  EXPECT_EQ(text, "small=drop&lakes.simplify=2&lakes.small=keep&roads.topology=fast");
  EXPECT_EQ(canonical_query(text), text);
  const auto parsed = parse(text);
  const auto& query = *parsed;
  EXPECT_EQ(query.value_for("lakes", ParameterId::simplify), ParameterValue(2.0));
  EXPECT_EQ(query.value_for("roads", ParameterId::simplify), std::nullopt);
  EXPECT_EQ(query.value_for("lakes", ParameterId::small), ParameterValue("keep"));
  EXPECT_EQ(query.value_for("roads", ParameterId::small), ParameterValue("drop"));
  EXPECT_EQ(query.value_for("roads", ParameterId::topology), ParameterValue("fast"));
  EXPECT_FALSE(parse("lakes.debug=tile")) << "marks are drawn over the whole tile";
}

TEST(StyleParametersTest, WrongGeneralizationsAreProblemsThatSayWhatIsAllowed) {
  for (const char* value : {"", "-1", "-0.001", "nan", "NaN", "-nan", "inf", "1e9", "64.001", "0x1",
                            "1px", " 1", "0,5", "1e999", "none", "%2B1"}) {
    const Problem problem = problem_of(std::string("lakes.simplify=") + value);
    EXPECT_EQ(problem.status, 400) << value;
    EXPECT_EQ(problem.parameter, "lakes.simplify");
    EXPECT_EQ(problem.takes, "a number from 0 to 64");
  }
  for (const char* value : {"", "dusty", "DUST", "dust,drop", "drop dust keep", " "}) {
    EXPECT_EQ(problem_of(std::string("small=") + value).takes, "one of drop, dust, keep") << value;
  }
  for (const char* value : {"", "Fast", "strict,fast", "none", "fast strict"}) {
    EXPECT_EQ(problem_of(std::string("topology=") + value).takes, "one of fast, strict") << value;
  }
  EXPECT_EQ(canonical_query("debug="), "debug=");
  for (const char* value : {",", "tile,", ",tile", "tile,,mesh", "tile%20mesh", "all", "mesh;"}) {
    EXPECT_EQ(problem_of(std::string("debug=") + value).takes,
              "some of faces, junctions, mesh, tile, vertices, separated by commas")
        << value;
  }
  EXPECT_EQ(problem_of("simplify=1&simplify=1").takes, "a number from 0 to 64, once");
}

Result<StyleQuery> parse_all(std::string_view query) {
  return StyleQuery::parse(decode_query(query).value(), kLayers);
}

std::string canonical_of_all(std::string_view query) {
  const auto parsed = parse_all(query);
  if (!parsed) return "problem: " + parsed.problem().detail;
  return parsed->canonical_text();
}

TEST(StyleParametersTest, ListsHaveOneText) {
  EXPECT_EQ(canonical_of_all("ids=3,1,2,1&highlight=-5"), "highlight=-5&ids=1%2C2%2C3");
  EXPECT_EQ(canonical_of_all("breaks=1.0,2e0,3.50"), "breaks=1%2C2%2C3.5");
  EXPECT_EQ(canonical_of_all("ramp=YLORRD-r"), "ramp=YlOrRd-r");
  EXPECT_EQ(canonical_of_all("stroke-dasharray=4,2.0"), "stroke-dasharray=4%2C2");
  EXPECT_EQ(canonical_of_all("classes='a':red,*:rgb(0,0,255),'null':lime,null:fff"),
            canonical_of_all("classes=a:f00,*:blue,'null':00ff00,null:white"));
  EXPECT_EQ(canonical_of_all("filter=a=1 and b=2"), canonical_of_all("filter=(b = 2)AND(a=1)"));
}

TEST(StyleParametersTest, EveryCanonicalTextReadsBackAsItself) {
  for (const char* query :
       {"ids=1,2&highlight=9223372036854775807", "breaks=-1e300,0.1,5&ramp=Set3",
        "classes='it''s, a:b':red,plain:blue,'':lime,*:000,null:fff&color-by=a b",
        "filter=\"a b\" LIKE '%25x' OR c IS NULL", "roads.pattern=dots&roads.pattern-angle=-360",
        "lakes.stroke=red&stroke-dasharray=0,1&stroke-width=32&opacity=0.3"}) {
    const std::string text = canonical_of_all(query);
    EXPECT_EQ(canonical_of_all(text), text) << query;
    EXPECT_THAT(text, ::testing::Not(::testing::StartsWith("problem"))) << query;
  }
}

TEST(StyleParametersTest, WrongListsAreProblemsThatSayWhatIsAllowed) {
  const std::string many_ids = [] {
    std::string text = "0";
    for (int i = 1; i < 300; ++i) text += "," + std::to_string(i);
    return text;
  }();
  const std::vector<std::pair<std::string, std::vector<std::string>>> wrong = {
      {"ids", {"", "a", "1,", ",1", "1.5", "1 ,2", "9223372036854775808", many_ids}},
      {"breaks", {"", "1,1", "2,1", "1,nan", "1,inf", "1,,2", "x"}},
      {"ramp", {"", "Blue", "Blues-x", "blues-r-r"}},
      {"stroke-dasharray", {"", "0", "0,0", "-1,2", "1,2,3,4,5,6,7,8,9", "257"}},
      {"stroke-width", {"-1", "33", "nan"}},
      {"stroke-linejoin", {"", "Round", "arcs"}},
      {"pattern", {"", "plaid"}},
      {"pattern-size", {"1", "65"}},
      {"classes",
       {"", "a", "a:", ":red", "a:red,", "a:red,a:blue", "a:red;b:blue", "'a:red", "a:rgb(1,2",
        "*:red,*:blue", "a:nocolour", "a:red,,b:blue"}},
      {"color-by", {"", std::string(200, 'x')}},
      {"filter", {"", "a", "a==1", "a=1)", "SELECT 1"}}};
  for (const auto& [name, values] : wrong) {
    for (const std::string& value : values) {
      const auto parsed = parse_all(name + "=" + percent_encode(value));
      ASSERT_FALSE(parsed) << name << "=" << value;
      const auto& problem = parsed.problem();
      EXPECT_EQ(problem.status, 400);
      EXPECT_EQ(problem.parameter, name);
      EXPECT_EQ(problem.takes, describe_values(*find_style_parameter(name)));
    }
  }
}

TEST(StyleParametersTest, WhateverIsAskedIsAStyleOrAProblem) {
  const std::vector<std::string> values = {
      "red",   "f00",    "1",     "0.5", "-1", "1,2,3", "3,2",        "a:red,*:blue", "Blues",
      "a = 1", "nan",    "",      "*",   "'",  "hatch", "rgb(1,2,3)", "none",         "mesh,tile",
      "\xff",  "null:1", "1e308", ",",   ":",  "fast",  "a LIKE '%'", "round",        "a:rgb(,b:1"};
  std::mt19937 random(3);
  const auto pick = [&random](std::size_t size) {
    return std::uniform_int_distribution<std::size_t>(0, size - 1)(random);
  };
  int styles = 0;
  for (int i = 0; i < 100'000; ++i) {
    std::vector<QueryPair> pairs;
    for (std::size_t k = pick(5); k > 0; --k) {
      const auto parameters = style_parameters();
      std::string name(parameters[pick(parameters.size())].name);
      if (pick(4) == 0) name = "roads." + name;
      pairs.emplace_back(std::move(name), values[pick(values.size())]);
    }
    const auto parsed = StyleQuery::parse(pairs, kLayers);
    if (!parsed) continue;
    ++styles;
    const std::string text = parsed->canonical_text();
    ASSERT_EQ(canonical_of_all(text), text);
  }
  EXPECT_GT(styles, 10'000);
}

}  // namespace
}  // namespace trapeze
