// The access log: one line for every answered request.
//
// Thread-safety: all methods may be called from any thread. The log has its own writer thread, so
// answering a request never waits for a disk or a pipe. If the writer cannot keep up, the oldest
// lines are dropped; the server log reports how many, and why they could not be written.
#pragma once

#include <memory>
#include <string>

#include "server/config/config.h"
#include "server/http/http_server.h"

namespace trapeze {

class LineWriter;

/// The line of an answer, without a line end. As text it is the combined log format of web servers,
/// followed by the duration in seconds and X-Cache ("-" if there is none). Characters other than
/// printable ASCII are escaped, so a client cannot forge a line.
std::string access_line(const Answered& answered, LogFormat format);

class AccessLog {
 public:
  /// `target` is "stdout", "stderr", or the path of a file to append to. Throws std::runtime_error
  /// that names the file if it cannot be opened, or is a pipe without a reader.
  AccessLog(std::string target, LogFormat format);
  ~AccessLog();
  AccessLog(const AccessLog&) = delete;
  AccessLog& operator=(const AccessLog&) = delete;

  void write(const Answered& answered);

  /// Opens the file again, after it was renamed. If that fails, the server log reports it and the
  /// old file stays in use.
  void reopen();

  /// Waits until all lines have been written, but at most one second.
  void flush();

 private:
  const std::string target_;
  const LogFormat format_;
  const std::unique_ptr<LineWriter> writer_;
};

}  // namespace trapeze
