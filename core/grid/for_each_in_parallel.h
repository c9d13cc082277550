// Runs independent pieces of work on all cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <future>
#include <system_error>
#include <thread>
#include <vector>

namespace trapeze {

/// A fitting number of items for one call of the work if each of them takes little time.
constexpr std::size_t kItemsAtOnce = std::size_t{1} << 15;

/// Calls work(0), ..., work(count - 1), each once, on at most `max_threads` threads including the
/// caller's, and returns when all calls have ended. If the system has no more threads, those that
/// there are do the work. If any call throws, rethrows one of the exceptions.
template <typename Work>
void for_each_in_parallel(std::size_t count, std::size_t max_threads, const Work& work) {
  if (std::min(count, max_threads) <= 1) {  // querying the cores takes a system call
    for (std::size_t i = 0; i < count; ++i) work(i);
    return;
  }
  std::atomic<std::size_t> next = 0;
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  const std::size_t threads = std::min({count, max_threads, cores});
  std::vector<std::future<void>> others;
  try {
    while (others.size() + 1 < threads) others.push_back(std::async(std::launch::async, run));
  } catch (const std::system_error&) {
    // A limit of threads, or no memory for their stacks: at least the caller's is there.
  }
  run();
  for (std::future<void>& other : others) other.get();
}

}  // namespace trapeze
