#include "server/base/digest.h"

#include <gtest/gtest.h>

namespace trapeze {
namespace {

// Computed with sha256sum.
TEST(DigestTest, IsTheBeginningOfSha256) {
  EXPECT_EQ(digest_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4");
  EXPECT_EQ(digest_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a3");
}

}  // namespace
}  // namespace trapeze
