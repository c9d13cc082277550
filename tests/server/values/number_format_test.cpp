#include "server/values/number_format.h"

#include <gtest/gtest.h>

#include <limits>

namespace trapeze {
namespace {

std::string written(double number, std::string_view format) {
  return formatted(number, parse_number_format(format).value());
}

TEST(NumberFormatTest, WritesNumbersForPeople) {
  EXPECT_EQ(written(1234567.891, ",.1f"), "1,234,567.9");
  EXPECT_EQ(written(1234567.891, ","), "1,234,567.891");
  EXPECT_EQ(written(-123456, ","), "-123,456");
  EXPECT_EQ(written(999, ","), "999");
  EXPECT_EQ(written(1234.5, ".0f"), "1234");  // ties round to even
  EXPECT_EQ(written(-0.001, ".1f"), "0.0");
  EXPECT_EQ(written(0.1 + 0.2, "f"), "0.3");
  EXPECT_EQ(written(0.256, ".1%"), "25.6%");
  EXPECT_EQ(written(12, ",.0%"), "1,200%");
}

TEST(NumberFormatTest, WritesPowersOfAThousandAsPrefixes) {
  EXPECT_EQ(written(12'345'678, ".3s"), "12.3M");
  EXPECT_EQ(written(999'999, ".3s"), "1.00M");
  EXPECT_EQ(written(999'499, ".3s"), "999k");
  EXPECT_EQ(written(1500, "s"), "1.5k");
  EXPECT_EQ(written(-42, ".2s"), "-42");
  EXPECT_EQ(written(0.00123, ".2s"), "1.2m");
  EXPECT_EQ(written(0, ".2s"), "0");
  EXPECT_EQ(written(123'456, ".2s"), "120k");
  EXPECT_EQ(written(-0.126, ".2s"), "-130m");
  EXPECT_EQ(written(960, ".1s"), "1k");
  EXPECT_EQ(written(345, ".1s"), "300");
}

TEST(NumberFormatTest, WritesEveryDouble) {
  for (const double number : {std::numeric_limits<double>::max(), 5e-324, -1e21, 1e20}) {
    for (const char* format : {",.9f", "f", ".9%", ".9s", "s"}) {
      EXPECT_LE(written(number, format).size(), 320u) << number << " " << format;
    }
  }
}

TEST(NumberFormatTest, IsReadBackFromItsText) {
  for (const char* text : {"f", ",f", ",.1f", ".0%", ",.2%", "s", ".3s"}) {
    EXPECT_EQ(number_format_text(parse_number_format(text).value()), text);
  }
  for (const char* text : {"", ".f", ".10f", "d", "x", ",,", ".1e", "1f", ",s", "f "}) {
    EXPECT_FALSE(parse_number_format(text)) << text;
  }
}

TEST(NumberFormatTest, TellsNumbersApartThatAreAStepApart) {
  EXPECT_EQ(formatted(12345.678, format_for_step(1000)), "12,346");
  EXPECT_EQ(formatted(0.12345, format_for_step(0.02)), "0.123");
}

}  // namespace
}  // namespace trapeze
