#include "server/documents/attribute_values.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

class AttributeValuesTest : public ::testing::Test {
 protected:
  nlohmann::json json(const std::string& target) {
    return nlohmann::json::parse(*sample_.get(target).body);
  }

  testing::SampleSite sample_;
};

TEST_F(AttributeValuesTest, CountsAllFeaturesOrThoseOfABox) {
  const auto all = json("/values/rings/rank");
  EXPECT_EQ(all["features"], 1);
  EXPECT_EQ(all["missing"], 0);
  EXPECT_EQ(all["distinct"], 1);
  EXPECT_EQ(all["values"], nlohmann::json::parse(R"([{"value": 1, "count": 1}])"));
  EXPECT_EQ(all["quantiles"], nlohmann::json::parse("[1]"));
  EXPECT_EQ(json("/values/rings/rank?bbox=-60,-1,-59,1"), all);
  EXPECT_EQ(json("/values/rings/rank?bbox=-180,-85,180,85"), all);
  EXPECT_EQ(json("/values/rings/rank?bbox=-91,-1,-90.01,1")["features"], 0) << "just beside it";
  EXPECT_EQ(json("/values/rings/rank?bbox=30,-1,31,1")["features"], 0) << "in its hole";
  const auto none = json("/values/rings/rank?bbox=120,-1,121,1");
  EXPECT_EQ(none["features"], 0);
  EXPECT_TRUE(none["values"].empty());
  EXPECT_TRUE(none["quantiles"].empty());
}

TEST_F(AttributeValuesTest, TakesBoxesOverTheAntimeridian) {
  EXPECT_EQ(json("/values/rings/rank?bbox=170,-1,-59,1")["features"], 1) << "its west in the east";
  EXPECT_EQ(json("/values/rings/rank?bbox=-60,-1,-170,1")["features"], 1) << "and its east";
  EXPECT_EQ(json("/values/rings/rank?bbox=170,-1,-100,1")["features"], 0);
  EXPECT_EQ(json("/values/rings/rank?bbox=180,-1,-100,1")["features"], 0);
  // As maps have it, which go on east of the world and west of it.
  EXPECT_EQ(json("/values/rings/rank?bbox=170,-1,301,1")["features"], 1);
  EXPECT_EQ(json("/values/rings/rank?bbox=300,-1,301,1")["features"], 1);
  EXPECT_EQ(json("/values/rings/rank?bbox=-420,-1,-419,1")["features"], 1);
  EXPECT_EQ(json("/values/rings/rank?bbox=-500,-1,-460,1")["features"], 0);
  EXPECT_EQ(json("/values/rings/rank?bbox=-900,-90,900,90")["features"], 1) << "all of the world";
}

TEST_F(AttributeValuesTest, CountsOnlyWhatIsDrawn) {
  EXPECT_EQ(json("/values/rings/rank?filter=rank%3D1")["features"], 1);
  EXPECT_EQ(json("/values/rings/rank?filter=rank%3E1")["features"], 0);
}

TEST_F(AttributeValuesTest, TextsHaveNoQuantiles) {
  const auto names = json("/values/rings/name");
  EXPECT_EQ(names["values"][0]["value"], "a square with a hole, and an island in the hole");
  EXPECT_FALSE(names.contains("quantiles"));
}

TEST_F(AttributeValuesTest, WhatIsWrongIsSaid) {
  for (const char* box :
       {"", "1", "1,2,3", "1,2,3,4,5", "0,1,1,0", "0,-91,1,0", "0,0,1,91", "nan,0,1,1"}) {
    const auto response = sample_.get(std::string("/values/rings/rank?bbox=") + box);
    EXPECT_EQ(response.status, 400) << box;
    EXPECT_EQ(nlohmann::json::parse(*response.body)["parameter"], "bbox") << box;
  }
  EXPECT_EQ(sample_.get("/values/rings/rank?simplify=-1").status, 400);
  for (const char* target :
       {"/values/rings", "/values/rings/nosuch", "/values/nosuch/rank", "/values/rings/rank/1"}) {
    EXPECT_EQ(sample_.get(target).status, 404) << target;
  }
}

}  // namespace
}  // namespace trapeze
