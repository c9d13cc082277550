// Reads the layers to serve, and reads them again on request or when their files change.
//
// Only layers that have changed, or may have changed, are read again. New layers are built while
// the old ones are still served, then all are replaced at the same time; workers that still draw
// from old layers keep these alive. If anything goes wrong, the old layers stay, and log and
// metrics report it.
//
// Thread-safety: all methods may be called from any thread.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/changes/change_log.h"
#include "server/config/config.h"
#include "server/data/dataset.h"
#include "server/data/live_layer.h"
#include "server/service/metrics.h"
#include "server/tiles/tile_service.h"

namespace trapeze {

/// The layers to serve, and the files that determine them.
struct LayerSource {
  /// The layers as currently configured. Throws std::exception that says what is wrong.
  std::function<std::vector<LayerConfig>()> layers;
  std::string config;  // path of the configuration, which is watched as well; empty: none
  /// The tables of values as configured when layers() was last called; empty: there are none.
  std::function<std::map<std::string, ValueTableConfig>()> values = {};
};

class Reloader {
 public:
  /// The intervals between checks for changes.
  struct Pace {
    std::chrono::milliseconds watch{0};   // of the files; 0: they are not checked
    std::chrono::milliseconds live{250};  // of the databases of layers with a live_query
  };

  /// Does nothing until start(). A change of files takes effect when two consecutive checks see the
  /// same state; a change in a database takes effect immediately. All references must outlive the
  /// reloader. `changes`, if it is not null, is notified of every new state in order.
  Reloader(LayerSource source, Pace pace, CurrentDataset& data, TileService& tiles,
           Metrics& metrics, ChangeLog* changes, std::function<void()> give_up,
           std::function<void()> is_loaded);
  /// Like end(), but waits as long as it takes for the current reading to finish.
  ~Reloader();
  Reloader(const Reloader&) = delete;
  Reloader& operator=(const Reloader&) = delete;

  /// Starts reading the layers in a thread of its own. If the first reading fails, calls `give_up`
  /// from that thread and does nothing more; otherwise calls `is_loaded` from there once. Call it
  /// once.
  void start();

  /// Makes the thread read the layers again soon.
  void reload();

  /// Stops reading layers, and waits for the current reading or database query, but at most that
  /// long. Returns false if it takes longer: it cannot be interrupted.
  bool end(std::chrono::milliseconds patience);

  /// Whether layers are being read at the moment.
  bool is_loading() const { return is_loading_; }
  /// Throws the error of the first reading of the layers.
  void rethrow_failure() const;
  /// The progress of each layer that is being read, or was read last.
  std::vector<LayerProgress> progress() const { return to_read_.get(); }
  /// What went wrong the last time, as text; empty if nothing did.
  std::string last_problem() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Retired;
  /// A query to the database of a layer that has not been answered yet.
  struct Question {
    std::string layer;
    Clock::time_point since;
    bool is_told = false;  // that it takes long: already logged
  };
  class Asking;

  void work();
  void follow();
  bool load_first();
  void load_again();
  void serve();
  using ValueTables = std::map<std::string, ValueTableConfig>;
  std::vector<std::string> watched_files(const std::vector<LayerConfig>& layers,
                                         const ValueTables& values) const;
  bool wait_for_a_reason();
  bool has_settled_change();
  void publish(std::shared_ptr<const Dataset> loaded);
  static void begin_live(std::vector<LiveLayer>& live, std::shared_ptr<const Dataset>& loaded);
  /// Applies changes from databases. Returns false if a layer has to be read in full again.
  bool follow_live();
  void note_of_databases(const std::string& problem);
  void watch_databases();
  /// Tells of files that are mapped and have been damaged, once of each state.
  void look_for_damage();
  void forget_retired();
  void note(const std::string& problem);

  const LayerSource source_;
  const Pace pace_;
  CurrentDataset& data_;
  TileService& tiles_;
  Metrics& metrics_;
  ChangeLog* const changes_;
  const std::function<void()> give_up_;
  const std::function<void()> is_loaded_;
  const std::shared_ptr<Retired> retired_;

  LayersToRead to_read_;

  // Used by the thread only.
  std::vector<std::string> files_;
  std::string state_read_;  // of the files when they were last read
  std::string state_seen_;  // of the files at the last check
  Clock::time_point last_look_;
  Clock::time_point last_load_;
  Clock::time_point last_look_for_damage_;
  std::vector<LiveLayer> live_;

  std::atomic<bool> is_loading_ = true;
  mutable std::mutex mutex_;  // guards everything below
  std::condition_variable wake_;
  bool is_asked_ = false;
  bool is_stopping_ = false;
  bool has_ended_ = true;         // the thread has ended or was never started
  std::string problem_;           // with reading the layers
  std::string damage_;            // to files of served layers
  std::string database_problem_;  // with querying databases for changes
  std::optional<Question> question_;
  std::exception_ptr failure_;
  std::thread thread_;
  std::thread watching_;  // watches unanswered queries; runs once there is a live layer
};

}  // namespace trapeze
