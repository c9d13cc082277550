#include "server/base/result.h"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>

namespace trapeze {
namespace {

Result<int> half_of(int number) {
  if (number % 2 != 0) return Problem(400, "odd");
  return number / 2;
}

Result<std::string> text_of_half(int number) {
  const Result<int> half = half_of(number);
  if (!half) return half.problem();
  return std::to_string(*half);
}

TEST(ResultTest, HoldsAValueOrAProblem) {
  EXPECT_TRUE(half_of(8));
  EXPECT_EQ(*half_of(8), 4);
  EXPECT_FALSE(half_of(7));
  EXPECT_EQ(half_of(7).problem().detail, "odd");
}

TEST(ResultTest, AProblemIsHandedOnToAResultOfAnotherType) {
  EXPECT_EQ(*text_of_half(8), "4");
  EXPECT_EQ(text_of_half(8)->size(), 1u);
  EXPECT_EQ(text_of_half(7).problem().status, 400);
}

TEST(ResultTest, AValueIsMovedOut) {
  Result<std::unique_ptr<int>> result = std::make_unique<int>(5);
  const std::unique_ptr<int> value = *std::move(result);
  EXPECT_EQ(*value, 5);
}

TEST(ResultTest, AnAbsentValueIsAValue) {
  const Result<std::optional<double>> nothing = std::optional<double>();
  ASSERT_TRUE(nothing);
  EXPECT_EQ(*nothing, std::nullopt);
}

TEST(ResultTest, AProblemIsChangedInPlace) {
  Result<int> result = half_of(7);
  result.problem().status = 404;
  EXPECT_EQ(std::move(result).problem().status, 404);
}

}  // namespace
}  // namespace trapeze
