// Writes lines to a file, a device or a pipe in a thread of its own, so that callers never wait for
// a disk or for the reader of a pipe.
//
// Thread-safety: all methods may be called from any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

namespace trapeze {

/// A file opened for appending.
class LineFile {
 public:
  /// `target` is "stdout", "stderr", or the path of a file, which is created if it does not exist.
  /// Throws std::runtime_error that names it if it cannot be opened or is a pipe without a reader.
  explicit LineFile(const std::string& target);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  int descriptor() const { return descriptor_; }
  /// Whether writing may fail until there is room, so that one has to wait.
  bool may_be_full() const { return may_be_full_; }

 private:
  void open_pipe_anew();

  int descriptor_ = -1;
  bool is_own_ = false;
  bool may_be_full_ = false;
};

/// Why a LineFile cannot be opened for the target, as text; empty if it can. Creates no file.
std::string find_target_problem(const std::string& target);

class LineWriter {
 public:
  /// Called by the writer thread; either may be empty.
  struct Events {
    /// So many lines were lost; writing has resumed.
    std::function<void(std::uint64_t lines)> lost;
    /// The file accepts no data; `words` says why. Not called again until something has been
    /// written.
    std::function<void(const std::string& words)> failed;
  };

  explicit LineWriter(std::shared_ptr<const LineFile> file, Events events = {});
  /// Writes the waiting lines, but gives up after a second if nothing is accepted.
  ~LineWriter();
  LineWriter(const LineWriter&) = delete;
  LineWriter& operator=(const LineWriter&) = delete;

  /// Adds a line end. If four megabytes are waiting already, the oldest lines are dropped.
  void write(std::string line);
  /// Sets the file for all lines from here on.
  void redirect(std::shared_ptr<const LineFile> file);
  /// Waits until everything has been written, but at most that long.
  void flush(std::chrono::milliseconds patience);

 private:
  using Clock = std::chrono::steady_clock;
  struct Line {
    std::string text;
    std::shared_ptr<const LineFile> file;
  };

  void work();
  bool put(const Line& line);
  bool wait_for_room(const LineFile& file) const;
  void note_failure(int error);
  void tell_what_is_lost();

  const Events events_;
  bool has_failed_ = false;  // whether writing the last line failed; used by the thread only
  /// The file whose last line is incomplete; null: none. Used by the thread only.
  std::shared_ptr<const LineFile> broken_;

  mutable std::mutex mutex_;  // guards everything below
  std::condition_variable wake_;
  std::condition_variable is_idle_;
  std::shared_ptr<const LineFile> file_;
  std::deque<Line> queue_;
  std::size_t waiting_bytes_ = 0;
  std::uint64_t lost_ = 0;  // and not yet reported
  bool is_writing_ = false;
  bool is_stopping_ = false;
  Clock::time_point give_up_at_ = Clock::time_point::max();
  std::thread thread_;
};

}  // namespace trapeze
