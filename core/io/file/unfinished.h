// Files and folders that are being written and have not got their final name: nothing of them is
// left behind, however the program ends.
#pragma once

#include <string>
#include <system_error>

namespace trapeze {

/// A name beside an output for what is being written, with the id of the process in it. What a
/// process that was killed left of the same output is removed, if no process has its id any more.
/// The destructor removes what has the name, a folder with all that is in it.
///
/// Thread-safety: different ones may be used by different threads.
class Unfinished {
 public:
  /// OUTPUT.tmp.PID; the file is not made yet.
  static Unfinished file_beside(const std::string& output);
  /// .OUTPUT.tmp.PID, a new and empty folder. Throws std::system_error if it cannot be made.
  static Unfinished folder_beside(const std::string& output);
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  const std::string& path() const { return path_; }

  /// Gives `from`, which is this or lies in it, the name `to`, in place of what had it.
  static void give_name(const std::string& from, const std::string& to, std::error_code& error);

 private:
  enum class Kind { file, folder };
  Unfinished(std::string path, Kind kind);

  const std::string path_;
};

/// Removes all that is unfinished in this process; what is begun, or given a name, after that waits
/// for ever. For who ends the process at once.
void remove_unfinished();

}  // namespace trapeze
