// The changes from each state of the data served to the next: kept for clients that request which
// tiles to purge, and passed to a command.
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
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/base/limits.h"
#include "server/changes/changed_tiles.h"
#include "server/data/dataset.h"
#include "server/labels/label_book.h"

namespace trapeze {

/// The changes of one layer between two states.
struct ChangedLayer {
  std::string name;
  bool is_everything = false;  // it was added or removed, or could not be compared
  /// Otherwise: the tiles that may look different in any style with the layer's own simplify,
  /// except styles that name ids.
  ChangedTiles tiles;
};

class ChangeLog {
 public:
  struct Options {
    ZoomRange zooms;
    /// The largest scale of tiles that are served.
    int most_scale = kMaxScale;
    /// For one zoom of a layer: if more tiles changed, only those of the zooms before it are
    /// listed.
    std::size_t most_tiles = 100'000;
    /// Run by /bin/sh. Its standard input has a line for each tile, "LAYER Z/X/Y", and a line
    /// "LAYER Z/*" for a layer of which everything may have changed from that zoom on. The
    /// environment variables TRAPEZE_SINCE and TRAPEZE_GENERATION contain the two generations.
    /// Changes made while it runs are combined and passed on when it has finished. Empty: no
    /// command.
    std::string command;
    /// Places the labels of the layers' own styles. Without fonts, labels are not considered.
    std::shared_ptr<LabelBook> labels = std::make_shared<LabelBook>();
  };

  explicit ChangeLog(Options options);
  /// Terminates a running command, as end_command() does.
  ~ChangeLog();
  ChangeLog(const ChangeLog&) = delete;
  ChangeLog& operator=(const ChangeLog&) = delete;

  /// Where the layers that changed are in memory: those of live layers share most of it.
  enum class Memory { apart, shared };
  /// Records that `after` follows `before`; they are compared in a thread of this object, and kept
  /// until then. Of states with memory of their own, only the last few are kept while they wait:
  /// layers that changed between those before count as changed everywhere.
  void note(std::shared_ptr<const Dataset> before, std::shared_ptr<const Dataset> after,
            Memory memory = Memory::apart);

  struct Answer {
    enum class State { known, pending, unknown } state = State::unknown;
    std::vector<ChangedLayer> layers;  // if known
  };
  /// The changes between the two generations, if both are among the last few.
  Answer between(std::string_view since, std::string_view generation) const;

  /// Terminates a running command and waits for that; no other one is started.
  void end_command();
  /// Whether two states are being compared, which cannot be interrupted. After end_command(), no
  /// other comparison starts.
  bool is_comparing() const;

  ZoomRange zooms() const { return options_.zooms; }

 private:
  struct Step {
    std::string since;
    std::string generation;
    std::shared_ptr<const Dataset> before;  // kept until they have been compared
    std::shared_ptr<const Dataset> after;
    /// Layers that changed in steps that were combined into this one.
    std::set<std::string> in_full;
    std::vector<ChangedLayer> layers;
    Memory memory = Memory::apart;
    bool is_taken = false;  // by the comparing thread
    bool is_compared = false;
  };
  /// Several consecutive steps combined.
  struct Sum {
    std::string since;
    std::string generation;
    std::map<std::string, ChangedLayer> layers;  // by name
  };

  void stop();
  void compare_steps();
  std::vector<ChangedLayer> compare(const Step& step) const;
  void take_changes(Step& step, std::vector<ChangedLayer> layers);
  void combine_waiting();
  static std::set<std::string> names_of(const Step& step);
  enum class Change { none, of_some_tiles, of_all_tiles };
  static Change change_of(const Step& step, const std::string& name);
  void tell_command();
  void run_command(const Sum& changes);

  const Options options_;
  mutable std::mutex mutex_;  // guards everything below
  std::condition_variable wake_;
  std::deque<std::shared_ptr<Step>> steps_;
  std::optional<Sum> untold_;  // not yet passed to the command
  bool is_comparing_ = false;
  bool is_stopping_ = false;
  std::thread comparing_;
  std::thread telling_;  // runs if there is a command
};

/// The lines for a command.
std::string change_lines(const std::vector<ChangedLayer>& layers);
/// The JSON for /changes.
std::string changes_json(std::string_view since, std::string_view generation,
                         const std::vector<ChangedLayer>& layers);

}  // namespace trapeze
