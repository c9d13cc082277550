// Reads the layers that are served, and reads them again when told to or when their files change.
//
// Only layers that have changed, or may have, are read again. New ones are built beside the old
// ones and all take their place at once; a worker that still draws from old ones keeps them alive.
// If anything goes wrong, the old ones stay, and log and metrics say so.
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

/// What is to be served, and the files that decide about it.
struct LayerSource {
  /// The layers as configured at this moment. Throws std::exception that says what is wrong.
  std::function<std::vector<LayerConfig>()> layers;
  std::string config;  // the path of the configuration, watched as well; empty: there is none
  /// The tables of values as layers() found them configured the last time; empty: none are.
  std::function<std::map<std::string, ValueTableConfig>()> values = {};
};

class Reloader {
 public:
  /// The time between looks at what may change.
  struct Pace {
    std::chrono::milliseconds watch{0};   // at the files; 0: none
    std::chrono::milliseconds live{250};  // at the databases of layers that have a live_query
  };

  /// Does nothing until start(). A change of files is taken up when two looks in a row see the
  /// same, one of a database at once. All references outlive the reloader.
  /// `changes`, if it is not null, is told of all states that follow each other.
  Reloader(LayerSource source, Pace pace, CurrentDataset& data, TileService& tiles,
           Metrics& metrics, ChangeLog* changes, std::function<void()> give_up,
           std::function<void()> is_loaded);
  /// Waits for the end of what is being read, as end() does but for as long as it takes.
  ~Reloader();
  Reloader(const Reloader&) = delete;
  Reloader& operator=(const Reloader&) = delete;

  /// Begins to read the layers in a thread of its own. If they cannot be read the first time, calls
  /// `give_up` from that thread, and does no more; else it calls `is_loaded` from there once. Call
  /// it once.
  void start();

  /// Reads the layers again, soon.
  void reload();

  /// Reads no layers any more, and waits for what is being read or asked of a database, but no
  /// longer than that. False if it takes longer: it cannot be interrupted.
  bool end(std::chrono::milliseconds patience);

  /// Whether layers are being read at this moment.
  bool is_loading() const { return is_loading_; }
  /// Throws what went wrong with reading the layers for the first time.
  void rethrow_failure() const;
  /// How far each layer is of those that are being read, or were read last.
  std::vector<LayerProgress> progress() const { return to_read_.get(); }
  /// What went wrong the last time, in words; empty if nothing did.
  std::string last_problem() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Retired;
  /// Asked of the database of a layer, and not answered yet.
  struct Question {
    std::string layer;
    Clock::time_point since;
    bool is_told = false;  // that it takes long
  };
  class Asking;

  void work();
  void follow();
  bool load_first();
  void load_again();
  void serve(const std::vector<LayerConfig>& layers);
  using ValueTables = std::map<std::string, ValueTableConfig>;
  std::vector<std::string> watched_files(const std::vector<LayerConfig>& layers,
                                         const ValueTables& values) const;
  bool wait_for_a_reason();
  bool has_settled_change();
  void publish(std::shared_ptr<const Dataset> loaded);
  void begin_live(std::vector<LiveLayer> live, std::shared_ptr<const Dataset>& loaded);
  /// Takes up what has changed in databases. False if a layer has to be read whole again.
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

  // Of the thread.
  std::vector<std::string> files_;
  std::string state_read_;  // of the files when they were last read
  std::string state_seen_;  // of the files at the last look
  Clock::time_point last_look_;
  Clock::time_point last_load_;
  Clock::time_point last_look_for_damage_;
  std::vector<LiveLayer> live_;

  std::atomic<bool> is_loading_ = true;
  mutable std::mutex mutex_;  // guards all below
  std::condition_variable wake_;
  bool is_asked_ = false;
  bool is_stopping_ = false;
  bool has_ended_ = true;         // the thread, or it has not been started
  std::string problem_;           // with reading the layers
  std::string damage_;            // to files of the layers that are served
  std::string database_problem_;  // with asking what has changed
  std::optional<Question> question_;
  std::exception_ptr failure_;
  std::thread thread_;
  std::thread watching_;  // databases that do not answer; runs once there is a live layer
};

}  // namespace trapeze
