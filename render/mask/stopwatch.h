// Measures the time that the steps of a picture take.
#pragma once

#include <chrono>

namespace trapeze {

/// Adds the time from its construction to its destruction to a sum.
class Stopwatch {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Stopwatch(double& sum_ms) : sum_ms_(sum_ms) {}
  ~Stopwatch() {
    sum_ms_ += std::chrono::duration<double, std::milli>(Clock::now() - begin_).count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& sum_ms_;
  const Clock::time_point begin_ = Clock::now();
};

}  // namespace trapeze
