// Programs that a benchmark starts beside itself, and ends.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

namespace trapeze {

/// A running program with all that it starts itself. It ends with this object, and with the process
/// that made it.
class ChildProcess {
 public:
  /// `arguments[0]` is the program, looked for in PATH; what it writes goes to the file `log`.
  /// `environment` adds NAME=VALUE. Throws std::runtime_error if it cannot be started.
  ChildProcess(const std::vector<std::string>& arguments, const std::string& log,
               const std::vector<std::string>& environment = {});
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  bool is_running();
  /// Seconds of processor time that it and its running children have used until now.
  double cpu_seconds() const;
  /// Waits for its end; the exit status, or 128 and the signal.
  int wait();

 private:
  pid_t pid_ = -1;  // also its process group
  bool has_ended_ = false;
  int status_ = 0;
};

/// Runs a program to its end. Throws std::runtime_error with its command if it fails.
void run_to_end(const std::vector<std::string>& arguments, const std::string& log);

/// A TCP port of this machine that nothing listens on just now.
std::uint16_t free_port();

}  // namespace trapeze
