#include "server/styles/parameter_table.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

namespace trapeze {
namespace {

TEST(ParameterTableTest, TheReadmeHoldsItAsItIs) {
  std::ifstream file(TRAPEZE_README);
  const std::string readme{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  EXPECT_THAT(readme, ::testing::HasSubstr("\n\n" + parameter_table() + "\n"))
      << "copy in what `trapeze parameters` prints";
}

}  // namespace
}  // namespace trapeze
