#include "core/grid/name_table.h"

#include <gtest/gtest.h>

#include <optional>

namespace trapeze {
namespace {

enum class Side { left, right };

constexpr NameTable<Side, 2> kSides({{"right", Side::right}, {"left", Side::left}});
static_assert(kSides.find("left") == Side::left);

TEST(NameTableTest, EachNameHasItsValueAndEachValueItsName) {
  for (const Side side : {Side::left, Side::right}) {
    EXPECT_EQ(kSides.find(kSides.name_of(side)), side);
  }
  EXPECT_EQ(kSides.find("LEFT"), std::nullopt);
  EXPECT_EQ(kSides.find(""), std::nullopt);
}

TEST(NameTableTest, KeepsTheOrderThatItWasWrittenIn) {
  EXPECT_EQ(kSides.names()[0], "right");
  EXPECT_EQ(kSides.values()[0], Side::right);
}

}  // namespace
}  // namespace trapeze
