#include "server/documents/identify.h"

#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "core/layer/layer_builder.h"
#include "server/data/title_attribute.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class IdentifyTest : public ::testing::Test {
 protected:
  nlohmann::json json(const std::string& target) {
    return nlohmann::json::parse(*sample_.get(target).body);
  }
  /// The layers of the features at the place, in the order of the answer.
  std::vector<std::string> layers(const std::string& target) {
    std::vector<std::string> names;
    const auto answer = json(target);
    for (const auto& feature : answer["features"]) names.push_back(feature["layer"]);
    return names;
  }

  testing::SampleSite sample_;
};

TEST_F(IdentifyTest, TheZoomIsGivenOnce) {
  EXPECT_EQ(sample_.get("/identify/rings/-60,0?z=4").status, 200);
  EXPECT_EQ(sample_.get("/identify/rings/-60,0?z=4&z=5").status, 400);
}

TEST_F(IdentifyTest, TellsTheAttributesAndTheIdOfTheSource) {
  const auto response = sample_.get("/identify/rings/-60,0");
  ASSERT_EQ(response.status, 200);
  EXPECT_EQ(response.header("Content-Type"), "application/geo+json");
  const auto json = nlohmann::json::parse(*response.body);
  EXPECT_EQ(json["type"], "FeatureCollection");
  EXPECT_EQ(json["numberMatched"], 1);
  EXPECT_EQ(json["numberReturned"], 1);
  const auto& feature = json["features"][0];
  EXPECT_EQ(feature["type"], "Feature");
  EXPECT_EQ(feature["id"], 7);
  EXPECT_EQ(feature["layer"], "rings");
  EXPECT_TRUE(feature["geometry"].is_null());
  EXPECT_EQ(feature["properties"]["name"], "a square with a hole, and an island in the hole");
  EXPECT_EQ(feature["properties"]["rank"], 1);
  EXPECT_NEAR(feature["bbox"][0], -90, 1e-6);
  EXPECT_NEAR(feature["bbox"][3], 66.5132604, 1e-6);
}

TEST_F(IdentifyTest, TellsTheTitleAndWhereThePartUnderThePlaceIs) {
  const auto mainland = json("/identify/rings/-60,0")["features"][0];
  EXPECT_EQ(mainland["title"], "a square with a hole, and an island in the hole");
  EXPECT_FALSE(mainland.contains("part_bbox")) << "it is as large as the whole";
  const auto island = json("/identify/rings/0,0")["features"][0];
  EXPECT_EQ(island["bbox"], mainland["bbox"]);
  EXPECT_NEAR(island["part_bbox"][0], -22.5, 1e-6);
  EXPECT_NEAR(island["part_bbox"][2], 22.5, 1e-6);
  const auto drawn_there = json("/identify/rings/30,0?z=0&rings.simplify=64")["features"][0];
  EXPECT_EQ(drawn_there["part_bbox"], island["part_bbox"]) << "the nearest, in the hole";
}

TEST(TitleAttributeTest, IsNamedOrFoundByItsName) {
  const FeatureTable table({{"ID", FieldType::integer},
                            {"Label", FieldType::text},
                            {"NAME", FieldType::text},
                            {"name:en", FieldType::text}});
  EXPECT_EQ(title_field(table), 2);
  EXPECT_EQ(title_field(table, "Label"), 1);
  EXPECT_EQ(title_field(table, "label"), std::nullopt) << "what is set is taken as it is written";
  EXPECT_EQ(title_field(FeatureTable({{"names", FieldType::text}})), std::nullopt);
}

TEST(TitleAttributeTest, IsTextWhateverItsType) {
  FeatureTable table({{"name", FieldType::text}, {"number", FieldType::integer}});
  table.append(1, std::vector<Value>{std::string_view("Aare"), std::int64_t{12}});
  table.append(2, std::vector<Value>{std::monostate(), std::monostate()});
  EXPECT_EQ(title_of(table, 0, 0), "Aare");
  EXPECT_EQ(title_of(table, 1, 0), "12");
  EXPECT_EQ(title_of(table, 0, 1), "");
  EXPECT_EQ(title_of(table, 1, 1), "");
  EXPECT_EQ(title_of(table, std::nullopt, 0), "");
}

TEST_F(IdentifyTest, SeesHolesAndIslands) {
  EXPECT_THAT(layers("/identify/rings/-60,0"), ElementsAre("rings"));
  EXPECT_THAT(layers("/identify/rings/30,0"), ElementsAre()) << "the hole";
  EXPECT_THAT(layers("/identify/rings/0,0"), ElementsAre("rings")) << "the island";
  EXPECT_THAT(layers("/identify/rings/100,0"), ElementsAre());
}

TEST_F(IdentifyTest, TheTopmostLayerComesFirst) {
  EXPECT_THAT(layers("/identify/rings,west/-60,0"), ElementsAre("west", "rings"));
  EXPECT_THAT(layers("/identify/west,rings/-60,0"), ElementsAre("rings", "west"));
  EXPECT_THAT(layers("/identify/rings,west/-100,0"), ElementsAre("west"));
}

TEST_F(IdentifyTest, WithAZoomFindsWhatIsDrawnThere) {
  EXPECT_THAT(layers("/identify/rings/0,0?z=0"), ElementsAre("rings"));
  EXPECT_THAT(layers("/identify/rings/0,0?z=0&simplify=32"), ElementsAre()) << "no island left";
  EXPECT_THAT(layers("/identify/rings/30,0?z=0&rings.simplify=64"), ElementsAre("rings"))
      << "no hole left";
  EXPECT_THAT(layers("/identify/west/-100,0?z=5.9"), ElementsAre("west"));
  EXPECT_THAT(layers("/identify/west/-100,0?z=6"), ElementsAre()) << "drawn up to zoom 5";
}

TEST_F(IdentifyTest, TheEndsOfTheWorldCanBeAsked) {
  for (const char* place : {"-180,85.0511", "-180,-85.0511", "-1e-7,0", "-180,85.05112877980659"}) {
    EXPECT_THAT(layers(std::string("/identify/west/") + place), ElementsAre("west")) << place;
  }
  EXPECT_EQ(sample_.get("/identify/west/180,-85.05112877980659").status, 200);
}

TEST_F(IdentifyTest, WhatIsWrongIsSaid) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"/identify/rings/181,0", "lon,lat"},
      {"/identify/rings/0,86", "lon,lat"},
      {"/identify/rings/0", "lon,lat"},
      {"/identify/rings/nan,0", "lon,lat"},
      {"/identify/rings/0,0,0", "lon,lat"},
      {"/identify/rings/a,b", "lon,lat"},
      {"/identify/rings/0,0?z=25", "z"},
      {"/identify/rings/0,0?z=-1", "z"},
      {"/identify/rings/0,0?z=nan", "z"},
      {"/identify/rings/0,0?z=", "z"},
      {"/identify/a%20b/0,0", "layers"},
      {"/identify//0,0", "layers"},
      {"/identify/rings/0,0?simplify=-1", "simplify"}};
  for (const auto& [target, parameter] : wrong) {
    const auto response = sample_.get(target);
    EXPECT_EQ(response.status, 400) << target;
    EXPECT_EQ(nlohmann::json::parse(*response.body)["parameter"], parameter) << target;
  }
  for (const char* target :
       {"/identify", "/identify/rings", "/identify/rings/0,0/0", "/identify/nosuch/0,0"}) {
    EXPECT_EQ(sample_.get(target).status, 404) << target;
  }
}

TEST_F(IdentifyTest, WaitsForTheData) {
  testing::SampleSite loading(/*is_loaded=*/false);
  EXPECT_EQ(loading.get("/identify/rings/0,0").status, 503);
}

/// A layer "many" of `count` equal squares around 0 E, 0 N.
ServedLayer many_squares(std::uint32_t count) {
  FeatureTable features({{"number", FieldType::integer}, {"share", FieldType::real}});
  std::vector<LayerBuilder> builders(1);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::int64_t number = std::numeric_limits<std::int64_t>::max() - i;
    features.append(-number, std::vector<Value>{number, std::numeric_limits<double>::quiet_NaN()});
    Rings rings;
    rings.add(std::vector<Point>{{-9, -9}, {9, -9}, {9, 9}, {-9, 9}});
    builders.front().add(i, rings);
  }
  ServedLayer served;
  served.config.name = "many";
  served.layer = LayerBuilder::join(builders, std::move(features));
  return served;
}

/// A layer "long" of equal squares around 0 E, 0 N with these texts.
ServedLayer squares_with(const std::vector<std::string>& texts) {
  FeatureTable features({{"text", FieldType::text}});
  std::vector<LayerBuilder> builders(1);
  for (std::uint32_t i = 0; i < texts.size(); ++i) {
    features.append(i, std::vector<Value>{std::string_view(texts[i])});
    Rings rings;
    rings.add(std::vector<Point>{{-9, -9}, {9, -9}, {9, 9}, {-9, 9}});
    builders.front().add(i, rings);
  }
  ServedLayer served;
  served.config.name = "long";
  served.layer = LayerBuilder::join(builders, std::move(features));
  return served;
}

TEST_F(IdentifyTest, LongTextsAreLeftOutOnceTheyAreTooMuch) {
  constexpr std::size_t kMegabyte = std::size_t{1} << 20;
  std::vector<ServedLayer> layers;
  // Each control character takes six bytes in JSON.
  layers.push_back(squares_with({std::string(kMegabyte, 'a'), std::string(kMegabyte, '\1'), "short",
                                 std::string(2 * kMegabyte, 'b'), std::string(20 * kMegabyte, 'c'),
                                 std::string(kMegabyte - 1000, 'd')}));
  sample_.data().set(std::make_shared<const Dataset>(std::move(layers)));
  const auto response = sample_.get("/identify/long/0,0");
  EXPECT_EQ(response.status, 200);
  EXPECT_LT(response.body->size(), kMaxIdentifiedBytes + 10'000);
  const auto json = nlohmann::json::parse(*response.body);
  EXPECT_EQ(json["numberReturned"], 6);
  EXPECT_EQ(json["propertiesLeftOut"], 2);
  std::vector<std::size_t> sizes;
  for (const auto& feature : json["features"]) {
    EXPECT_EQ(feature["bbox"].size(), 4u);
    sizes.push_back(feature["properties"].is_null()
                        ? 0
                        : feature["properties"]["text"].get<std::string>().size());
  }
  EXPECT_THAT(sizes, ElementsAre(kMegabyte - 1000, 0, 2 * kMegabyte, 5, 0, kMegabyte))
      << "the topmost first";
}

TEST_F(IdentifyTest, AnswersStaySmallAndIntegersExact) {
  std::vector<ServedLayer> layers;
  layers.push_back(many_squares(150));
  sample_.data().set(std::make_shared<const Dataset>(std::move(layers)));
  const auto response = sample_.get("/identify/many/0,0");
  const auto json = nlohmann::json::parse(*response.body);
  EXPECT_EQ(json["numberMatched"], 150);
  EXPECT_EQ(json["numberReturned"], 100);
  EXPECT_EQ(json["features"].size(), 100u);
  // The topmost of them, the last of 150, is the first.
  EXPECT_EQ(json["features"][0]["id"], -9223372036854775658);
  EXPECT_THAT(*response.body, HasSubstr("\"number\": 9223372036854775658"));
  EXPECT_TRUE(json["features"][0]["properties"]["share"].is_null()) << "JSON has no NaN";
  EXPECT_FALSE(json.contains("propertiesLeftOut"));
}

}  // namespace
}  // namespace trapeze
