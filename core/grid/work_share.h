// How far a piece of work is, told by the thread that does it and asked by others.
#pragma once

#include <algorithm>
#include <atomic>

namespace trapeze {

/// Thread-safety: any thread may ask while one tells.
class WorkShare {
 public:
  /// What is told from here on, from 0 to 1, is the part of the work between these shares.
  void enter(double from, double to) {
    from_ = from;
    to_ = to;
    tell(0);
  }
  void tell(double share) {
    const double whole = from_ + (to_ - from_) * std::clamp(share, 0.0, 1.0);
    share_.store(static_cast<float>(whole), std::memory_order_relaxed);
  }

  /// Of the whole work.
  double get() const { return share_.load(std::memory_order_relaxed); }

 private:
  double from_ = 0;
  double to_ = 1;
  std::atomic<float> share_ = 0;
};

}  // namespace trapeze
