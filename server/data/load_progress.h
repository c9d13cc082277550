// Shows how far the loading of a file is: a bar when standard error is a terminal, otherwise a line
// in the log now and then.
//
// Thread-safety: one thread at a time.
#pragma once

#include <chrono>
#include <string>

namespace trapeze {

class LoadProgress {
 public:
  /// `name` is that of a source, which is shown without its password, or any words.
  explicit LoadProgress(const std::string& name);
  /// Takes the bar away again.
  ~LoadProgress();
  LoadProgress(const LoadProgress&) = delete;
  LoadProgress& operator=(const LoadProgress&) = delete;

  /// `share` is in [0, 1], or negative if unknown.
  void show(double share);

 private:
  using Clock = std::chrono::steady_clock;

  void draw_bar(double share) const;
  void log_line(double share) const;

  const std::string name_;
  const bool is_terminal_;
  const Clock::time_point begin_;
  Clock::time_point next_;
  bool is_bar_shown_ = false;
};

}  // namespace trapeze
