// Wall time.
#pragma once

#include <chrono>

namespace trapeze::experiment {

class Stopwatch {
 public:
  /// Milliseconds since it was made or asked last.
  double lap_ms() {
    const auto now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - begin_).count();
    begin_ = now;
    return ms;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace trapeze::experiment
