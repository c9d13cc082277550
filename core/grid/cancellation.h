// Whether the result of work in progress is still wanted.
//
// Thread-safety: all functions may be called from any thread. Changes become visible soon but
// impose no ordering on other memory accesses.
#pragma once

#include <atomic>
#include <chrono>
#include <stdexcept>

namespace trapeze {

/// Thrown by work that ends early because its result is no longer wanted.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("the work was not wanted any longer") {}
};

class Cancellation {
 public:
  using Clock = std::chrono::steady_clock;

  /// Over at the deadline; never, by default.
  explicit Cancellation(Clock::time_point deadline = Clock::time_point::max())
      : deadline_(deadline.time_since_epoch().count()) {}
  Cancellation(const Cancellation&) = delete;
  Cancellation& operator=(const Cancellation&) = delete;

  void cancel() noexcept { is_cancelled_.store(true, std::memory_order_relaxed); }
  void set_deadline(Clock::time_point deadline) noexcept {
    deadline_.store(deadline.time_since_epoch().count(), std::memory_order_relaxed);
  }
  Clock::time_point deadline() const noexcept {
    return Clock::time_point(Clock::duration(deadline_.load(std::memory_order_relaxed)));
  }

  /// Takes some 30 ns: call it every few microseconds of work, not more often.
  bool is_over() const noexcept {
    return is_cancelled_.load(std::memory_order_relaxed) || Clock::now() >= deadline();
  }
  /// Throws Cancelled if it is over.
  void check() const {
    if (is_over()) throw Cancelled();
  }

 private:
  std::atomic<bool> is_cancelled_{false};
  std::atomic<Clock::rep> deadline_;
};

/// Checks once every so many calls. A view of a cancellation, or of none if it is null.
class CancellationCheck {
 public:
  CancellationCheck(const Cancellation* cancellation, unsigned calls)
      : cancellation_(cancellation), calls_(calls) {}

  void operator()() {
    if (++count_ < calls_) return;
    count_ = 0;
    if (cancellation_ != nullptr) cancellation_->check();
  }

 private:
  const Cancellation* cancellation_;
  unsigned calls_;
  unsigned count_ = 0;
};

}  // namespace trapeze
