// A line for every request that was answered.
//
// Thread-safety: all methods may be called from any thread. Lines are written by a thread of the
// log's own: whoever answers requests never waits for a disk or a pipe. If it cannot keep up, the
// oldest lines are lost; the log of the server says how many, and what keeps them from being
// written.
#pragma once

#include <memory>
#include <string>

#include "server/config/config.h"
#include "server/http/http_server.h"

namespace trapeze {

class LineWriter;

/// The line of an answer, without a line end. As text it is what web servers call the combined
/// format, followed by the seconds it took and X-Cache ("-" if there is none); what is not
/// printable ASCII is escaped, so nothing that a client sends can forge a line.
std::string access_line(const Answered& answered, LogFormat format);

class AccessLog {
 public:
  /// `target`: "stdout", "stderr", or the path of a file, to which lines are appended. Throws
  /// std::runtime_error that names the file if it cannot be opened, or is a pipe that nobody reads.
  AccessLog(std::string target, LogFormat format);
  ~AccessLog();
  AccessLog(const AccessLog&) = delete;
  AccessLog& operator=(const AccessLog&) = delete;

  void write(const Answered& answered);

  /// Opens the file anew, after it was renamed. If that fails, says so in the log of the server and
  /// goes on with the old one.
  void reopen();

  /// Waits until all lines have been written, but no longer than a second.
  void flush();

 private:
  const std::string target_;
  const LogFormat format_;
  const std::unique_ptr<LineWriter> writer_;
};

}  // namespace trapeze
