// Lines to a file, a device or a pipe, written by a thread of their own: whoever has a line to
// write never waits for a disk or for who reads a pipe.
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

/// A file that is written at its end.
class LineFile {
 public:
  /// "stdout", "stderr", or the path of a file, which is made if there is none. Throws
  /// std::runtime_error, naming it, if it cannot be opened or is a pipe that nobody reads.
  explicit LineFile(const std::string& target);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  int descriptor() const { return descriptor_; }
  /// Whether it has to be waited until it takes more.
  bool may_be_full() const { return may_be_full_; }

 private:
  void open_pipe_anew();

  int descriptor_ = -1;
  bool is_own_ = false;
  bool may_be_full_ = false;
};

/// In words, why a LineFile cannot be made of the target; empty if it can. Makes no file.
std::string find_target_problem(const std::string& target);

class LineWriter {
 public:
  /// Called by the thread that writes; either may be empty.
  struct Events {
    /// So many lines have been lost, and it goes on now.
    std::function<void(std::uint64_t lines)> lost;
    /// The file takes nothing, in words; not told again until it has taken something.
    std::function<void(const std::string& words)> failed;
  };

  explicit LineWriter(std::shared_ptr<const LineFile> file, Events events = {});
  /// Writes what waits, but no longer than a second if nothing is taken.
  ~LineWriter();
  LineWriter(const LineWriter&) = delete;
  LineWriter& operator=(const LineWriter&) = delete;

  /// A line end is added. If four megabytes wait already, the oldest lines are lost.
  void write(std::string line);
  /// Where lines go from here on.
  void redirect(std::shared_ptr<const LineFile> file);
  /// Waits until all has been written, but no longer than that.
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
  bool has_failed_ = false;      // the last line; of the thread
  bool is_line_broken_ = false;  // the last one was written in part; of the thread

  mutable std::mutex mutex_;  // guards all below
  std::condition_variable wake_;
  std::condition_variable is_idle_;
  std::shared_ptr<const LineFile> file_;
  std::deque<Line> queue_;
  std::size_t waiting_bytes_ = 0;
  std::uint64_t lost_ = 0;  // and not yet told
  bool is_writing_ = false;
  bool is_stopping_ = false;
  Clock::time_point give_up_at_ = Clock::time_point::max();
  std::thread thread_;
};

}  // namespace trapeze
