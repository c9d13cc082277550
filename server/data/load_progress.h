// How far the loading of files is, for those who wait for it.
//
// Thread-safety: one thread at a time may use an object, but for LayersToRead.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace trapeze {

/// A bar when standard error is a terminal, otherwise a line in the log now and then.
class LoadProgress {
 public:
  /// `name` is that of a source, which is shown without its password, or any words.
  explicit LoadProgress(const std::string& name);
  /// Takes the bar away again.
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
  std::optional<int> percent;  // 100 when it is read; unknown of some sources
};

/// How far each of the layers is that are read together, for whoever asks meanwhile. Any number of
/// threads may use it.
class LayersToRead {
 public:
  /// Begins anew, with layers of which nothing is read yet.
  void begin(std::vector<LayerProgress> layers);
  /// `share` is in [0, 1], or negative if unknown.
  void show(std::size_t layer, double share);
  /// That layer is read.
  void finish(std::size_t layer);
  /// Empty before the first begin().
  std::vector<LayerProgress> get() const;

 private:
  mutable std::mutex mutex_;
  std::vector<LayerProgress> layers_;
};

/// Warns of sources that do not get on: a database that does not answer, a disk that hangs. They
/// cannot be told from what is slow, so the warning ends nothing.
class StallWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// Warns of what has not got on for so long.
  explicit StallWatch(const std::vector<std::string>& sources,
                      Clock::duration patience = std::chrono::seconds(30));

  void got_on(std::size_t source) { sources_[source].last = Clock::now(); }
  void finish(std::size_t source) { sources_[source].is_watched = false; }
  /// To be called now and then; warns of a source once.
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
