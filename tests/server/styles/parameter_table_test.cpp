#include "server/styles/parameter_table.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

namespace trapeze {
namespace {

TEST(ParameterTableTest, TheDocumentsHoldItAsItIs) {
  std::ifstream file(TRAPEZE_DOCS "/styling.md");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  EXPECT_THAT(text, ::testing::HasSubstr("\n\n" + parameter_table() + "\n"))
      << "copy in what `trapeze parameters` prints";
}

}  // namespace
}  // namespace trapeze
