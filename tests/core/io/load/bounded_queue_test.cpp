#include "core/io/load/bounded_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

namespace trapeze {
namespace {

TEST(BoundedQueueTest, GivesEverythingOutOnceAndInOrderToEachTaker) {
  BoundedQueue<int> queue(3);
  std::vector<std::vector<int>> taken(3);
  std::vector<std::thread> takers;
  for (std::vector<int>& mine : taken) {
    takers.emplace_back([&queue, &mine] {
      while (const std::optional<int> item = queue.pop()) mine.push_back(*item);
    });
  }
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(queue.push(i));
  queue.close();
  for (std::thread& taker : takers) taker.join();
  std::vector<int> all;
  for (const std::vector<int>& mine : taken) {
    EXPECT_TRUE(std::is_sorted(mine.begin(), mine.end()));
    all.insert(all.end(), mine.begin(), mine.end());
  }
  std::sort(all.begin(), all.end());
  ASSERT_EQ(all.size(), 1000u);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(all[i], i);
}

TEST(BoundedQueueTest, ClosingLetsOutWhatIsIn) {
  BoundedQueue<int> queue(3);
  queue.push(1);
  queue.close();
  EXPECT_FALSE(queue.push(2));
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_EQ(queue.pop(), std::nullopt);
}

TEST(BoundedQueueTest, AbandoningDropsWhatIsInAndFreesAWaitingMaker) {
  BoundedQueue<int> queue(1);
  queue.push(1);
  std::thread maker([&queue] { EXPECT_FALSE(queue.push(2)); });
  queue.abandon();
  maker.join();
  EXPECT_EQ(queue.pop(), std::nullopt);
}

}  // namespace
}  // namespace trapeze
