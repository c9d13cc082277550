#include "server/tiles/tile_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace trapeze {
namespace {

constexpr std::size_t kPicture = 1000;                 // bytes
constexpr std::size_t kBudget = std::size_t{4} << 20;  // about 3,000 such tiles

TileCache::Tile tile(char content, std::size_t size = kPicture) {
  return {std::make_shared<const std::string>(size, content), TileHint::none};
}

std::string key(const char* kind, int number) {
  return std::string(kind) + "/" + std::to_string(number);
}

int count_kept(TileCache& cache, const char* kind, int count) {
  int kept = 0;
  for (int i = 0; i < count; ++i) kept += cache.find(key(kind, i)).bytes != nullptr;
  return kept;
}

TEST(TileCacheTest, GivesBackWhatWasKept) {
  TileCache cache(kBudget);
  EXPECT_EQ(cache.find("a").bytes, nullptr);
  cache.insert("a", {std::make_shared<const std::string>("first"), TileHint::full});
  cache.insert("b", tile('b'));
  EXPECT_EQ(*cache.find("a").bytes, "first");
  EXPECT_EQ(cache.find("a").hint, TileHint::full);
  EXPECT_EQ(cache.find("b").bytes->front(), 'b');
  EXPECT_EQ(cache.figures().tiles, 2u);
  EXPECT_EQ(cache.figures().hits, 3u);
  EXPECT_EQ(cache.figures().misses, 1u);
}

TEST(TileCacheTest, NeverHoldsMoreThanItsBudget) {
  TileCache cache(kBudget);
  for (int i = 0; i < 20'000; ++i) {
    cache.insert(key("t", i), tile('t', static_cast<std::size_t>(i) * 7 % 5000));
    if (i % 3 == 0) cache.find(key("t", i / 2));
    if (i % 1000 == 0) {
      EXPECT_LE(cache.figures().bytes, kBudget);
    }
  }
  EXPECT_LE(cache.figures().bytes, kBudget);
  EXPECT_GT(cache.figures().bytes, kBudget / 2);
}

TEST(TileCacheTest, AScanDoesNotPushOutWhatIsAskedForOften) {
  TileCache cache(kBudget);
  constexpr int kPopular = 500;
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < kPopular; ++i) {
      if (cache.find(key("popular", i)).bytes == nullptr)
        cache.insert(key("popular", i), tile('p'));
    }
  }
  for (int i = 0; i < 50'000; ++i) cache.insert(key("scan", i), tile('s'));
  EXPECT_EQ(count_kept(cache, "popular", kPopular), kPopular);
}

TEST(TileCacheTest, WhatIsNotAskedForAnyMoreLeavesInTheEnd) {
  TileCache cache(kBudget);
  const auto use = [&cache](const char* kind) {
    for (int i = 0; i < 2'000; ++i) {
      if (cache.find(key(kind, i)).bytes == nullptr) cache.insert(key(kind, i), tile('u'));
    }
  };
  for (int round = 0; round < 4; ++round) use("yesterday");
  for (int round = 0; round < 12; ++round) use("today");
  EXPECT_GT(count_kept(cache, "today", 2'000), 1'800);
}

TEST(TileCacheTest, ATileTooLargeForTheBudgetIsNotKept) {
  TileCache cache(kBudget);
  cache.insert("large", tile('l', kBudget / 4));
  EXPECT_EQ(cache.find("large").bytes, nullptr);
  EXPECT_EQ(cache.figures().bytes, 0u);
}

TEST(TileCacheTest, ATileThatFitsIntoAShardIsKept) {
  TileCache cache(kBudget);
  for (int i = 0; i < 1'000; ++i) cache.insert(key("small", i), tile('s'));
  cache.insert("large", tile('l', kBudget / 16 / 2));
  EXPECT_NE(cache.find("large").bytes, nullptr);
  for (int i = 0; i < 20'000; ++i) cache.insert(key("scan", i), tile('s'));
  EXPECT_LE(cache.figures().bytes, kBudget);
}

TEST(TileCacheTest, WithoutABudgetNothingIsKept) {
  TileCache cache(0);
  cache.insert("a", tile('a', 0));
  EXPECT_EQ(cache.find("a").bytes, nullptr);
}

TEST(TileCacheTest, ThreadsMayShareIt) {
  TileCache cache(kBudget / 8);
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&cache, &wrong, t] {
      for (int i = 0; i < 5'000; ++i) {
        const int number = (i * (t + 3)) % 700;
        const auto content = static_cast<char>('a' + number % 26);
        const auto found = cache.find(key("n", number));
        if (found.bytes == nullptr) {
          cache.insert(key("n", number), tile(content));
        } else if (found.bytes->front() != content) {
          ++wrong;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_LE(cache.figures().bytes, kBudget / 8);
}

}  // namespace
}  // namespace trapeze
