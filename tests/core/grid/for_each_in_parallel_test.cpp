#include "core/grid/for_each_in_parallel.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <atomic>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/sanitized.h"

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

/// Ends the process: with 0 if all is done although the system gives no thread, with 2 if it does.
[[noreturn]] void work_without_more_threads() {
  const rlimit no_stack{1, 1};  // threads need address space
  setrlimit(RLIMIT_AS, &no_stack);
  int status = 1;
  try {
    std::atomic<int> done = 0;
    for_each_in_parallel(100, 2, [&done](std::size_t) { ++done; });
    status = done == 100 ? 0 : 1;
  } catch (const std::exception&) {
  }
  try {
    std::thread([] {}).join();
    status = 2;
  } catch (const std::exception&) {
  }
  std::_Exit(status);
}

TEST(ForEachInParallelDeathTest, DoesAllOfItIfTheSystemHasNoMoreThreads) {
  if (testing::kIsSanitized) GTEST_SKIP() << "sanitizers need address space themselves";
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "there is one core";
  EXPECT_EXIT(work_without_more_threads(), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace trapeze
