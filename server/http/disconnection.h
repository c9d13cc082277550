// Reports that a client disconnected before it was answered.
#pragma once

#include <functional>
#include <mutex>
#include <utility>

namespace trapeze {

/// Thread-safety: all methods may be called from any thread.
class Disconnection {
 public:
  /// Calls `action` when the client disconnects: immediately if it already has. Keeps at most one
  /// action.
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

  /// Called by the connection. A second call does nothing.
  void happen() {
    std::function<void()> action;
    {
      const std::lock_guard lock(mutex_);
      has_happened_ = true;
      action = std::exchange(action_, nullptr);
    }
    if (action) action();
  }

  /// Whether an action is set.
  bool is_awaited() const {
    const std::lock_guard lock(mutex_);
    return action_ != nullptr;
  }

 private:
  mutable std::mutex mutex_;  // guards everything below
  bool has_happened_ = false;
  std::function<void()> action_;
};

}  // namespace trapeze
