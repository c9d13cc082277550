// Programs that a benchmark starts and ends.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

namespace trapeze {

/// A running program with all processes it starts. It ends with this object, and with the process
/// that created it.
class ChildProcess {
 public:
  /// `arguments[0]` is the program, which is searched in PATH; its output goes to the file `log`.
  /// `environment` adds NAME=VALUE. Throws std::runtime_error if it cannot be started.
  ChildProcess(const std::vector<std::string>& arguments, const std::string& log,
               const std::vector<std::string>& environment = {});
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  bool is_running();
  /// Seconds of processor time that it and its running children have used so far.
  double cpu_seconds() const;
  /// Waits for its end; returns the exit status, or 128 plus the signal.
  int wait();

 private:
  pid_t pid_ = -1;  // also its process group
  bool has_ended_ = false;
  int status_ = 0;
};

/// Runs a program to its end. Throws std::runtime_error with its command if it fails.
void run_to_end(const std::vector<std::string>& arguments, const std::string& log);

/// A TCP port of this machine that is currently not in use.
std::uint16_t free_port();

}  // namespace trapeze
