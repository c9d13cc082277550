#include "core/grid/for_each_in_parallel.h"

#include <gmock/gmock.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace trapeze {
namespace {

TEST(ForEachInParallel, DoesEveryPieceOnce) {
  for (const std::size_t threads : {0, 1, 2, 100}) {
    std::vector<std::atomic<int>> times(1000);
    for_each_in_parallel(times.size(), threads, [&times](std::size_t i) { ++times[i]; });
    EXPECT_THAT(times, ::testing::Each(::testing::Eq(1)));
  }
  for_each_in_parallel(0, 8, [](std::size_t) { FAIL() << "there is nothing to do"; });
}

TEST(ForEachInParallel, ThrowsWhatAPieceThrew) {
  for (const std::size_t threads : {1, 2}) {
    EXPECT_THROW(for_each_in_parallel(100, threads,
                                      [](std::size_t i) {
                                        if (i == 73) throw std::domain_error("73");
                                      }),
                 std::domain_error);
  }
}

}  // namespace
}  // namespace trapeze
