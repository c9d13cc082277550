#include "server/base/gzip.h"

#include <gtest/gtest.h>

#include <string>

namespace trapeze {
namespace {

TEST(GzipTest, WhatWasCompressedComesBack) {
  for (const std::string& text : {std::string(), std::string("tiles"), std::string(500'000, 'x')}) {
    EXPECT_EQ(gunzip(gzip(text, kMostGzipLevel), text.size()), text);
    EXPECT_EQ(gunzip(gzip(text, 1), text.size()), text);
  }
}

TEST(GzipTest, EqualTextsBecomeEqualBytes) {
  EXPECT_EQ(gzip("tiles", 5), gzip("tiles", 5));
}

TEST(GzipTest, WhatIsNoneOrTooLongIsRefused) {
  const std::string compressed = gzip(std::string(100'000, 'x'), 9);
  EXPECT_FALSE(gunzip(compressed, 99'999).has_value());
  EXPECT_FALSE(gunzip(compressed.substr(0, compressed.size() - 9), 1'000'000).has_value());
  EXPECT_FALSE(gunzip("tiles", 100).has_value());
  EXPECT_FALSE(gunzip("", 100).has_value());
}

}  // namespace
}  // namespace trapeze
