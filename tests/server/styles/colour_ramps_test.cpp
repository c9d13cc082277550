#include "server/styles/colour_ramps.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

namespace trapeze {
namespace {

std::vector<std::string> hex(std::string_view ramp, std::size_t count) {
  std::vector<std::string> texts;
  const auto colours = ramp_colours(ramp, count);
  if (!colours) return texts;
  for (const Rgba colour : *colours) texts.push_back(to_hex(colour));
  return texts;
}

TEST(ColourRampsTest, GivesTheColoursOfEachNumberOfClasses) {
  EXPECT_THAT(hex("Blues", 3), ::testing::ElementsAre("deebf7ff", "9ecae1ff", "3182bdff"));
  EXPECT_THAT(hex("Blues", 4),
              ::testing::ElementsAre("eff3ffff", "bdd7e7ff", "6baed6ff", "2171b5ff"));
  EXPECT_EQ(hex("Blues", 9).back(), "08306bff");
  EXPECT_EQ(hex("RdBu", 11)[5], "f7f7f7ff");
  EXPECT_THAT(hex("Blues", 2), ::testing::ElementsAre("deebf7ff", "3182bdff"));
  EXPECT_THAT(hex("Set1", 2), ::testing::ElementsAre("e41a1cff", "377eb8ff"));
}

TEST(ColourRampsTest, EveryRampHasAllItsColoursInBothDirections) {
  std::istringstream names(ramp_names());
  int count = 0;
  for (std::string name; std::getline(names >> std::ws, name, ',');) {
    ++count;
    for (std::size_t n = 1; n <= 8; ++n) {
      auto colours = ramp_colours(name, n);
      ASSERT_TRUE(colours && colours->size() == n) << name << n;
      auto reversed = ramp_colours(name + "-r", n).value();
      std::ranges::reverse(reversed);
      EXPECT_EQ(*colours, reversed) << name << n;
      for (const Rgba colour : *colours) EXPECT_EQ(colour.a, 255);
    }
    EXPECT_FALSE(ramp_colours(name, 0));
  }
  EXPECT_EQ(count, 35);
}

TEST(ColourRampsTest, ScalesAreInterpolatedBeyondTheirLastList) {
  const auto nine = ramp_colours("Greens", 9).value();
  const auto seventeen = ramp_colours("Greens", 17).value();
  ASSERT_EQ(seventeen.size(), 17u);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(seventeen[2 * i], nine[i]);
  EXPECT_EQ(ramp_colours("Greens", 64).value().size(), 64u);
  EXPECT_FALSE(ramp_colours("Set1", 10)) << "unlike colours have none between";
}

TEST(ColourRampsTest, NamesAreFoundInAnyCaseAndWrittenInOne) {
  EXPECT_EQ(find_ramp("ylgnbu"), "YlGnBu");
  EXPECT_EQ(find_ramp("YLGNBU-R"), "YlGnBu-r");
  for (const char* name : {"", "-r", "Blue", "Blues-r-r", "Blues ", "schemeGroups"}) {
    EXPECT_FALSE(find_ramp(name)) << name;
  }
}

}  // namespace
}  // namespace trapeze
