#include "server/http/http_message.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace trapeze {
namespace {

TEST(HttpMessageTest, FindsTheTagInAList) {
  for (const char* header :
       {"\"a\"", "W/\"a\"", "\"b\", \"a\"", "\"b\",W/\"a\" ,\"c\"", "*", " * ", "\t\"a\""}) {
    EXPECT_TRUE(matches_entity_tag(header, "\"a\"")) << header;
  }
}

TEST(HttpMessageTest, OtherTagsDoNotMatch) {
  for (const char* header : {"", "a", "\"b\"", "\"ab\"", "\"a", ",,,", "w/\"a\"", "**", "\"*\""}) {
    EXPECT_FALSE(matches_entity_tag(header, "\"a\"")) << header;
  }
}

TEST(HttpMessageTest, ProblemsEchoHostileBytesAsHarmlessJson) {
  const std::string value = "\"</script>\x01\xff" + std::string(500, 'x');
  const auto response = problem_response({400, "No.", "fill", value, "a colour"});
  EXPECT_EQ(response.header("Content-Type"), "application/problem+json");
  const auto json = nlohmann::json::parse(*response.body);
  EXPECT_EQ(json["status"], 400);
  EXPECT_EQ(json["title"], "Bad Request");
  EXPECT_EQ(json["parameter"], "fill");
  EXPECT_EQ(json["takes"], "a colour");
  EXPECT_LT(json["value"].get<std::string>().size(), 80u);
}

TEST(HttpMessageTest, UnavailableSaysWhenToAskAgain) {
  EXPECT_EQ(problem_response({503, "Busy."}).header("Retry-After"), "1");
  EXPECT_EQ(problem_response({404, "No."}).header("Retry-After"), "");
}

}  // namespace
}  // namespace trapeze
