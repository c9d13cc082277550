#include "core/grid/item_count.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace trapeze {
namespace {

TEST(ItemCount, WhatThirtyTwoBitsCountMayGrow) {
  EXPECT_NO_THROW(require_countable(0, "vertices"));
  EXPECT_NO_THROW(require_countable(0xfffffffe, "vertices"));
}

TEST(ItemCount, WhatDoesNotFitIsRefusedWithTheFigure) {
  try {
    require_countable(0xffffffff, "vertices");
    FAIL() << "the number of none was taken";
  } catch (const std::length_error& error) {
    EXPECT_STREQ(error.what(), "4294967295 vertices, of which there can be 4294967294 at most");
  }
}

TEST(ItemCount, ALowerLimitIsNamed) {
  EXPECT_NO_THROW(require_countable(7, "versions", 7));
  EXPECT_THROW(require_countable(8, "versions", 7), std::length_error);
  EXPECT_EQ(too_many_words(8, "versions", 7), "8 versions, of which there can be 7 at most");
}

}  // namespace
}  // namespace trapeze
