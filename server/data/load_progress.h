// Progress of loading files.
//
// Thread-safety: one thread at a time may use an object, except for LayersToRead.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace trapeze {

/// A line with a bar that fits into a terminal of that many columns: a long name is cut at its
/// beginning. `share` is in [0, 1], or negative if unknown.
std::string progress_bar(const std::string& name, double share, std::size_t columns);

/// Shows a bar if standard error is a terminal, otherwise logs a line from time to time.
class LoadProgress {
 public:
  /// `name` is that of a source, which is shown without its password, or any text.
  explicit LoadProgress(const std::string& name);
  /// Removes the bar.
  ~LoadProgress();
  LoadProgress(const LoadProgress&) = delete;
  LoadProgress& operator=(const LoadProgress&) = delete;

  /// `share` is in [0, 1], or negative if unknown.
  void show(double share);

 private:
  using Clock = std::chrono::steady_clock;

  void draw_bar(double share) const;
  void log_line(double share) const;

  const std::string name_;
  const bool is_terminal_;
  const Clock::time_point begin_;
  Clock::time_point next_;
  bool is_bar_shown_ = false;
};

struct LayerProgress {
  std::string name;
  std::string title;
  std::optional<int> percent;  // 100 when it is read; unknown for some sources
};

/// The progress of each of the layers that are read together. Any number of threads may use it.
class LayersToRead {
 public:
  /// Starts with a new list of layers, none of which has been read.
  void begin(std::vector<LayerProgress> layers);
  /// `share` is in [0, 1], or negative if unknown.
  void show(std::size_t layer, double share);
  /// Marks that layer as read.
  void finish(std::size_t layer);
  /// Empty before the first begin().
  std::vector<LayerProgress> get() const;

 private:
  mutable std::mutex mutex_;
  std::vector<LayerProgress> layers_;
};

/// Warns about sources that make no progress: a database that does not answer, a disk that hangs.
/// Since they cannot be distinguished from slow ones, nothing is aborted.
class StallWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// Warns about sources without progress for that long.
  explicit StallWatch(const std::vector<std::string>& sources,
                      Clock::duration patience = std::chrono::seconds(30));

  void got_on(std::size_t source) { sources_[source].last = Clock::now(); }
  void finish(std::size_t source) { sources_[source].is_watched = false; }
  /// To be called regularly; warns once about each source.
  void look();

 private:
  struct Source {
    std::string name;
    Clock::time_point last;
    bool is_watched = true;
  };

  const Clock::duration patience_;
  std::vector<Source> sources_;
};

}  // namespace trapeze
