// What has changed from one state of the data to the next, as the server takes it up: kept for
// those who ask which tiles to purge, and given to a command.
//
// Thread-safety: all methods may be called from any thread.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/changes/changed_tiles.h"
#include "server/data/dataset.h"

namespace trapeze {

/// Of one layer, between two states.
struct ChangedLayer {
  std::string name;
  bool is_everything = false;  // it has come or gone, or could not be compared
  /// Otherwise: that may look different in any style with the layer's own simplify, but for styles
  /// that name ids.
  ChangedTiles tiles;
};

class ChangeLog {
 public:
  struct Options {
    ZoomRange zooms;
    /// Of one zoom of a layer: where more have changed, tiles are listed up to the zoom before it.
    std::size_t most_tiles = 100'000;
    /// For /bin/sh. Its input has a line for each tile, "LAYER Z/X/Y", and for a layer of which
    /// everything may have changed from some zoom on, "LAYER Z/*"; TRAPEZE_SINCE and
    /// TRAPEZE_GENERATION in its environment are the generations between which that is. What
    /// changes while it runs is told when it has ended, all at once. Empty: none.
    std::string command;
  };

  explicit ChangeLog(Options options);
  /// Ends a command that is running, as end_command() does.
  ~ChangeLog();
  ChangeLog(const ChangeLog&) = delete;
  ChangeLog& operator=(const ChangeLog&) = delete;

  /// Takes note that one follows the other, and compares them in a thread of its own.
  void note(std::shared_ptr<const Dataset> before, std::shared_ptr<const Dataset> after);

  struct Answer {
    enum class State { known, pending, unknown } state = State::unknown;
    std::vector<ChangedLayer> layers;  // if known
  };
  /// What has changed between the two generations, if both are among the last few.
  Answer between(std::string_view since, std::string_view generation) const;

  /// Ends a command that is running, and waits for that; no other is started.
  void end_command();

  ZoomRange zooms() const { return options_.zooms; }

 private:
  struct Step {
    std::string since;
    std::string generation;
    std::shared_ptr<const Dataset> before;  // until they have been compared
    std::shared_ptr<const Dataset> after;
    std::vector<ChangedLayer> layers;
    bool is_taken = false;  // by the thread that compares
    bool is_compared = false;
  };
  /// Several steps that follow each other, as one.
  struct Sum {
    std::string since;
    std::string generation;
    std::map<std::string, ChangedLayer> layers;  // by name
  };

  void compare_steps();
  std::vector<ChangedLayer> compare(const Step& step) const;
  void drop_oldest();
  void tell_command();
  void run_command(const Sum& changes);

  const Options options_;
  mutable std::mutex mutex_;  // guards all below
  std::condition_variable wake_;
  std::deque<std::shared_ptr<Step>> steps_;
  std::optional<Sum> untold_;  // what the command has not been told yet
  bool is_stopping_ = false;
  std::thread comparing_;
  std::thread telling_;  // runs if there is a command
};

/// As lines for a command.
std::string change_lines(const std::vector<ChangedLayer>& layers);
/// As JSON, for /changes.
std::string changes_json(std::string_view since, std::string_view generation,
                         const std::vector<ChangedLayer>& layers);

}  // namespace trapeze
