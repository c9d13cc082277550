// The server log, on standard error.
#pragma once

#include <memory>

namespace trapeze {

class LineWriter;

/// The pattern for spdlog: time, level, message.
inline constexpr const char* kServerLogPattern = "%Y-%m-%dT%H:%M:%S.%e %l %v";

/// While an object of this class exists, messages logged with spdlog are written by a separate
/// thread, so that logging never waits for the reader of the log. If the reader is too slow, the
/// oldest lines are dropped and a warning reports how many. Before and afterwards, each line is
/// written by the thread that logs it.
class ServerLog {
 public:
  /// No thread may log during construction and destruction.
  ServerLog();
  ~ServerLog();
  ServerLog(const ServerLog&) = delete;
  ServerLog& operator=(const ServerLog&) = delete;

  /// Waits until everything has been written, but at most one second.
  void flush();

 private:
  std::shared_ptr<LineWriter> writer_;
};

}  // namespace trapeze
