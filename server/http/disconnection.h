// That a client has gone before it was answered.
#pragma once

#include <functional>
#include <mutex>
#include <utility>

namespace trapeze {

/// Thread-safety: all methods may be called from any thread.
class Disconnection {
 public:
  /// Calls `action` when the client goes: at once if it has. At most one action is kept.
  void act(std::function<void()> action) {
    {
      const std::lock_guard lock(mutex_);
      if (!has_happened_) {
        action_ = std::move(action);
        return;
      }
    }
    action();
  }

  /// To be called by the connection. Does nothing the second time.
  void happen() {
    std::function<void()> action;
    {
      const std::lock_guard lock(mutex_);
      has_happened_ = true;
      action = std::exchange(action_, nullptr);
    }
    if (action) action();
  }

  /// Whether anybody wants to know.
  bool is_awaited() const {
    const std::lock_guard lock(mutex_);
    return action_ != nullptr;
  }

 private:
  mutable std::mutex mutex_;  // guards all below
  bool has_happened_ = false;
  std::function<void()> action_;
};

}  // namespace trapeze
