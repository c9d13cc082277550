// The log of the server itself, on standard error.
#pragma once

#include <memory>

namespace trapeze {

class LineWriter;

/// As spdlog takes it: time, level, words.
inline constexpr const char* kServerLogPattern = "%Y-%m-%dT%H:%M:%S.%e %l %v";

/// While this lives, what is logged by spdlog is written by a thread of its own: whoever logs does
/// not wait for who reads the log. If the reader is too slow, the oldest lines are lost and a
/// warning says how many. Before and after, each line is written by who logs it.
class ServerLog {
 public:
  /// Nobody logs meanwhile, here and at the end.
  ServerLog();
  ~ServerLog();
  ServerLog(const ServerLog&) = delete;
  ServerLog& operator=(const ServerLog&) = delete;

  /// Waits until all has been written, but for no longer than a second.
  void flush();

 private:
  std::shared_ptr<LineWriter> writer_;
};

}  // namespace trapeze
