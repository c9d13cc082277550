#include "server/base/nearest_name.h"

#include <gmock/gmock.h>

namespace trapeze {
namespace {

using ::testing::Optional;

const std::vector<std::string> kNames = {"serve", "config", "check", "fill", "fill-opacity"};

TEST(NearestNameTest, FindsWhatOneSlipLeadsTo) {
  EXPECT_THAT(nearest_name("sevre", kNames), Optional(std::string("serve"))) << "swapped";
  EXPECT_THAT(nearest_name("serv", kNames), Optional(std::string("serve"))) << "missing";
  EXPECT_THAT(nearest_name("cheeck", kNames), Optional(std::string("check"))) << "added";
  EXPECT_THAT(nearest_name("fall", kNames), Optional(std::string("fill"))) << "changed";
}

TEST(NearestNameTest, AllowsLongNamesMoreSlips) {
  EXPECT_THAT(nearest_name("fil-opacty", kNames), Optional(std::string("fill-opacity")));
}

TEST(NearestNameTest, CaseDoesNotCount) {
  EXPECT_THAT(nearest_name("SERVE", kNames), Optional(std::string("serve")));
}

TEST(NearestNameTest, DoesNotGuessWildly) {
  for (const char* far : {"", "x", "tiles", "nosuch", "opacity"}) {
    EXPECT_EQ(nearest_name(far, kNames), std::nullopt) << far;
  }
  EXPECT_EQ(nearest_name(std::string(100'000, 'e'), kNames), std::nullopt);
  EXPECT_EQ(nearest_name("x", {"y"}), std::nullopt) << "not a letter would be right";
}

TEST(NearestNameTest, EndsASentenceOnlyIfThereIsSuchAName) {
  EXPECT_EQ(did_you_mean("fil", kNames), "; did you mean fill?");
  EXPECT_EQ(did_you_mean("nosuch", kNames), "");
}

}  // namespace
}  // namespace trapeze
