#include "server/config/skip_limit.h"

#include <gmock/gmock.h>

#include <optional>
#include <string>

namespace trapeze {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

bool allows(const std::string& limit, std::size_t skipped, std::size_t features) {
  return SkipLimit::parse(limit).value().allows(skipped, features);
}

TEST(SkipLimitTest, TakesNumbersAndSharesAndNothingElse) {
  for (const char* text : {"0", "12", "0%", "1%", "0.5%", "100%"}) {
    const auto limit = SkipLimit::parse(text);
    ASSERT_TRUE(limit) << text;
    EXPECT_EQ(limit->text(), text);
  }
  EXPECT_EQ(SkipLimit::parse("2 %"), SkipLimit::parse("2%"));
  EXPECT_EQ(SkipLimit::parse("100%"), SkipLimit());
  for (const char* text : {"", "%", "-1", "1.5", "101%", "-1%", "nan%", "inf%", "1 ", "x", "1%%",
                           "99999999999999999999"}) {
    EXPECT_EQ(SkipLimit::parse(text), std::nullopt) << text;
  }
}

TEST(SkipLimitTest, AllowsAsManyAsItSays) {
  EXPECT_TRUE(allows("0", 0, 10));
  EXPECT_FALSE(allows("0", 1, 10));
  EXPECT_TRUE(allows("3", 3, 10));
  EXPECT_FALSE(allows("3", 4, 10));
  EXPECT_TRUE(allows("1%", 1, 100));
  EXPECT_FALSE(allows("1%", 1, 99));
  EXPECT_TRUE(allows("0%", 0, 0)) << "there was nothing to skip";
  EXPECT_TRUE(allows("100%", 10, 10));
}

TEST(SkipLimitTest, AnExcessIsToldWithTheFileAndTheFigures) {
  LoadReport report;
  report.path = "/maps/houses.gpkg";
  report.features = 400;
  report.skipped = 5;
  EXPECT_THAT(find_excess(report, SkipLimit::parse("1%").value()),
              AllOf(HasSubstr("/maps/houses.gpkg: 5 of 400 features"), HasSubstr("(1.25 %)"),
                    HasSubstr("at most 1% may be")));
  EXPECT_THAT(find_excess(report, SkipLimit::parse("5").value()), IsEmpty());
  EXPECT_THAT(find_excess(report, SkipLimit()), IsEmpty());
}

}  // namespace
}  // namespace trapeze
