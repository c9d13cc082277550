// Progress of a piece of work, reported by the thread that does it and read by others.
#pragma once

#include <algorithm>
#include <atomic>

namespace trapeze {

/// Thread-safety: any thread may read while one reports.
class WorkShare {
 public:
  /// From here on, reports from 0 to 1 cover the part of the work between these shares.
  void enter(double from, double to) {
    from_ = from;
    to_ = to;
    tell(0);
  }
  void tell(double share) {
    const double whole = from_ + (to_ - from_) * std::clamp(share, 0.0, 1.0);
    share_.store(static_cast<float>(whole), std::memory_order_relaxed);
  }

  /// Share of the whole work.
  double get() const { return share_.load(std::memory_order_relaxed); }

 private:
  double from_ = 0;
  double to_ = 1;
  std::atomic<float> share_ = 0;
};

}  // namespace trapeze
