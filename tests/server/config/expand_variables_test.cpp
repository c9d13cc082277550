#include "server/config/expand_variables.h"

#include <gmock/gmock.h>

namespace trapeze {
namespace {

using ::testing::HasSubstr;

const char* find(const std::string& name) {
  if (name == "HOME") return "/home/map";
  if (name == "EMPTY") return "";
  if (name == "TRICKY") return "${HOME}$$";
  return nullptr;
}

TEST(ExpandVariablesTest, ReplacesVariablesAndNothingElse) {
  const std::pair<const char*, const char*> cases[] = {
      {"", ""},
      {"plain", "plain"},
      {"${HOME}/a.fgb", "/home/map/a.fgb"},
      {"${HOME}${HOME}", "/home/map/home/map"},
      {"${NONE:-/srv}/a", "/srv/a"},
      {"${EMPTY:-/srv}/a", "/srv/a"},
      {"${EMPTY}/a", "/a"},
      {"${NONE:-}a", "a"},
      {"${HOME:-/srv}", "/home/map"},
      {"$${HOME}", "${HOME}"},
      {"5 $ or $5", "5 $ or $5"},
      {"$", "$"},
      {"${TRICKY}", "${HOME}$$"},
  };
  for (const auto& [text, expanded] : cases) {
    const ExpandedText result = expand_variables(text, find);
    EXPECT_EQ(result.text, expanded) << text;
    EXPECT_EQ(result.problem, "") << text;
  }
}

TEST(ExpandVariablesTest, SaysWhatIsWrong) {
  EXPECT_THAT(expand_variables("a${NONE}", find).problem, HasSubstr("NONE is not set"));
  EXPECT_THAT(expand_variables("a${HOME", find).problem, HasSubstr("no \"}\""));
  for (const char* text : {"${}", "${A B}", "${A-B}", "${:-x}", "${$HOME}"}) {
    EXPECT_THAT(expand_variables(text, find).problem, HasSubstr("names no variable")) << text;
  }
}

}  // namespace
}  // namespace trapeze
