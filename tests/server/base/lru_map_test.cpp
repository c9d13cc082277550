#include "server/base/lru_map.h"

#include <gtest/gtest.h>

#include <string>

namespace trapeze {
namespace {

TEST(LruMapTest, FindsWhatWasPutIn) {
  LruMap<std::string, int> map(100);
  EXPECT_EQ(map.find("a"), nullptr);
  map.insert("a", 1, 10);
  ASSERT_NE(map.find("a"), nullptr);
  EXPECT_EQ(*map.find("a"), 1);
  EXPECT_EQ(map.bytes(), 10u);
}

TEST(LruMapTest, TheOneNotUsedForLongestGoes) {
  LruMap<int, int> map(30);
  for (int i = 1; i <= 3; ++i) map.insert(i, i, 10);
  EXPECT_NE(map.find(1), nullptr);
  map.insert(4, 4, 10);
  EXPECT_EQ(map.find(2), nullptr);
  EXPECT_NE(map.find(1), nullptr);
  EXPECT_NE(map.find(3), nullptr);
  EXPECT_EQ(map.bytes(), 30u);
}

TEST(LruMapTest, ALargeOneTakesThePlaceOfAll) {
  LruMap<int, int> map(30);
  for (int i = 1; i <= 3; ++i) map.insert(i, i, 10);
  EXPECT_EQ(map.insert(4, 44, 100), 44);
  for (int i = 1; i <= 3; ++i) EXPECT_EQ(map.find(i), nullptr);
  EXPECT_EQ(*map.find(4), 44);
  map.insert(5, 5, 10);
  EXPECT_EQ(map.find(4), nullptr);
  EXPECT_EQ(map.bytes(), 10u);
}

}  // namespace
}  // namespace trapeze
