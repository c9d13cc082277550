// Files and folders that are being written and do not have their final name yet: nothing of them is
// left behind, however the program ends.
#pragma once

#include <string>
#include <system_error>

namespace trapeze {

/// A temporary name beside an output, containing the process id and a random number. Removes
/// leftovers of a killed process for the same output, if no process has that id any more. The
/// destructor removes whatever has the name: the file, or the folder with its contents.
///
/// Thread-safety: different objects may be used by different threads.
class Unfinished {
 public:
  /// OUTPUT.tmp.PID-RANDOM; the file is not created yet.
  static Unfinished file_beside(const std::string& output);
  /// .OUTPUT.tmp.PID-RANDOM, a new and empty folder. Throws std::system_error if it cannot be
  /// created.
  static Unfinished folder_beside(const std::string& output);
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  const std::string& path() const { return path_; }

  /// Renames `from`, which is this file or folder or lies in it, to `to`, replacing anything of
  /// that name.
  static void give_name(const std::string& from, const std::string& to, std::error_code& error);

 private:
  enum class Kind { file, folder };
  Unfinished(std::string path, Kind kind);

  const std::string path_;
};

/// Removes everything unfinished in this process. Starting or renaming unfinished files blocks
/// forever after that. For callers that are about to end the process.
void remove_unfinished();

}  // namespace trapeze
