#include "server/base/problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace trapeze {
namespace {

using ::testing::HasSubstr;

TEST(ProblemTest, TitleIsTheReasonPhraseOfTheStatus) {
  EXPECT_THAT(problem_json(Problem(404, "x")), HasSubstr("\"title\": \"Not Found\""));
  EXPECT_THAT(problem_json(Problem(409, "x")), HasSubstr("\"title\": \"Conflict\""));
  EXPECT_THAT(problem_json(Problem(431, "x")),
              HasSubstr("\"title\": \"Request Header Fields Too Large\""));
}

TEST(ProblemTest, WhatTheRequestSaidIsCutAndEscaped) {
  const std::string json =
      problem_json(Problem(400, "x", "fill", std::string(100, 'a') + "\"\xff", "a colour"));
  EXPECT_THAT(json, HasSubstr("\"value\": \"" + std::string(64, 'a') + "...\""));
  EXPECT_THAT(problem_json(Problem(400, "x", "fill", "\"\xff", "a colour")),
              HasSubstr(R"("value": "\"�")"));
}

}  // namespace
}  // namespace trapeze
