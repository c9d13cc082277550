// Draws tiles on worker threads: takes a plan, returns bytes. Knows nothing about HTTP.
//
// Expensive tiles have a queue of their own and use at most half of the workers, so that cheap
// tiles continue to be drawn meanwhile. Large tiles are drawn in bands, with the help of idle
// workers. Labels that are requested for the first time are placed by a separate thread, which may
// take longer than any deadline: meanwhile tiles with such labels wait, without a worker.
//
// Thread-safety: all methods may be called from any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "core/grid/cancellation.h"
#include "core/grid/name_table.h"
#include "server/base/defaults.h"
#include "server/labels/label_book.h"
#include "server/styles/feature_classes.h"
#include "server/tiles/painted_tile.h"
#include "server/tiles/tile_cache.h"
#include "server/tiles/tile_plan.h"

namespace trapeze {

class TilePainter;

enum class TileOutcome : std::uint8_t {
  drawn,
  kept,       // found by its fingerprint, so not drawn
  held,       // every client already has it, so there are no bytes
  saturated,  // the queue is full, or the service is stopping: retrying may help
  late,       // the deadline passed before or during drawing
  withdrawn,  // by the client
  placing,    // the deadline passed while its labels were being placed: retrying may help
  damaged,    // its file is truncated or modified, which has been logged
  failed,     // an internal error, which has been logged
};

inline constexpr NameTable<TileOutcome, 9> kTileOutcomeNames({
    {"drawn", TileOutcome::drawn},
    {"kept", TileOutcome::kept},
    {"held", TileOutcome::held},
    {"saturated", TileOutcome::saturated},
    {"late", TileOutcome::late},
    {"withdrawn", TileOutcome::withdrawn},
    {"placing", TileOutcome::placing},
    {"damaged", TileOutcome::damaged},
    {"failed", TileOutcome::failed},
});

struct TileAnswer {
  TileOutcome outcome = TileOutcome::failed;
  PaintedTile tile;  // if drawn, kept or held

  /// Whether the tile was found by its fingerprint or drawn, so that the fingerprint is known.
  bool is_known() const { return outcome <= TileOutcome::held; }
};

struct TileServiceOptions {
  // How many distinct tiles may wait for a worker: cheap and expensive ones are counted separately.
  std::size_t queue = defaults::kQueue;
  std::chrono::milliseconds deadline = defaults::kDeadline;  // from submission to the answer
  // The maximum number of tiles that a worker draws in one pass, if that is faster than one by one.
  // A worker does not wait for more tiles; but a tile waits until all tiles of its pass are drawn.
  std::size_t batch = defaults::kBatch;
  // For debug marks.
  std::shared_ptr<const Fonts> fonts = std::make_shared<const Fonts>();
  std::shared_ptr<LabelBook> labels = std::make_shared<LabelBook>();
  // Finds a previously drawn tile by its fingerprint; returns null bytes if there is none.
  std::function<TileCache::Tile(const std::string& fingerprint)> find_kept = {};
  // Called once for every tile, however many clients requested it, from the thread that answers.
  std::function<void(const TileAnswer&)> observe = {};
};

class TileService {
 public:
  using Clock = std::chrono::steady_clock;
  using Callback = std::function<void(const TileAnswer&)>;
  /// Whether the client already has the tile with that fingerprint and needs no bytes. Called from
  /// a worker with the service locked.
  using Holds = std::function<bool(const std::string& fingerprint)>;
  /// Dear and giant tiles wait in a queue of their own. Memory that a giant tile used is freed
  /// immediately afterwards.
  enum class Cost { cheap, dear, giant };

  struct Order {
    TilePlan plan;
    std::string key;  // of the plan
    Cost cost = Cost::cheap;
    /// Whether the tile need not be drawn if its fingerprint turns out to be kept, or held by all
    /// clients. If false, it is drawn regardless of its fingerprint.
    bool may_be_known = true;
  };

 private:
  struct Flight;

 public:
  /// Identifies one submitted request.
  class Ticket {
    friend class TileService;
    std::weak_ptr<Flight> flight_;
    std::size_t number_ = 0;
  };

  /// Starts one worker for each renderer; there must be at least one. Throws std::system_error if a
  /// thread cannot be started.
  TileService(TileServiceOptions options, std::vector<std::unique_ptr<MaskRenderer>> renderers);
  /// Waiting requests are answered as saturated. Tiles being drawn are answered as late, as soon as
  /// their workers notice.
  ~TileService();
  TileService(const TileService&) = delete;
  TileService& operator=(const TileService&) = delete;

  /// Calls `callback` exactly once: from a worker, or within this call if the queue is full, or
  /// within withdraw(). Plans with equal keys that are in progress at the same time are drawn once.
  /// An empty `holds` holds nothing. Throws std::bad_alloc, and never calls back, if there is no
  /// memory to queue the request.
  Ticket submit(Order order, Callback callback, Holds holds = {});

  /// The answer that submit() would give for a plan of that cost whose tile need not be drawn, if
  /// it can be found within this call faster than by handing it to a worker: within a tenth of a
  /// millisecond. Returns nothing if the tile has to be drawn, and always for the following plans,
  /// which must be submitted: those with many trapezoids, of layers in several parts, with debug
  /// marks, with labels that have not been placed, with classes that no recent tile had, and of a
  /// file that was truncated.
  std::optional<TileAnswer> answer_at_once(const TilePlan& plan, std::uint64_t cost,
                                           const Holds& holds);

  /// Answers this request, unless that has been done. If no other request wants the tile, its
  /// drawing stops.
  void withdraw(const Ticket& ticket);

  /// The renderer's name, one word.
  const std::string& renderer_name() const { return renderer_name_; }

  /// Places the labels that the configuration alone gives to layers, each layer separately, so that
  /// no tile has to wait for it.
  void place_usual_labels(const std::shared_ptr<const Dataset>& dataset);

  /// Whether labels are being placed for tiles, which cannot be interrupted: the service ends only
  /// after that.
  bool is_placing() const;

  /// See LabelBook::cost_of().
  std::uint64_t cost_of_labels(const TilePlan& plan) const;

  struct Figures {
    std::size_t waiting = 0;  // distinct tiles that wait for a worker
    std::size_t drawing = 0;  // distinct tiles that a worker has taken
  };
  Figures figures() const;

  /// Releases what the renderers keep for a mesh. Call it once nothing draws that mesh any more:
  /// drawing it again would keep it again.
  void forget(std::uint64_t mesh_id) { renderer_.forget(mesh_id); }

 private:
  struct Asker {
    Callback callback;  // empty: withdrawn
    Holds holds;
  };
  struct Flight {
    Order order;
    Clock::time_point submitted;
    Cancellation cancellation;  // at the last client's deadline
    std::vector<Asker> askers;
    std::size_t wanted = 0;  // askers that have not withdrawn
    TileCache::Tile kept;    // set by the drawing worker if the tile was found
  };
  /// The bands of a large tile.
  struct Bands {
    std::shared_ptr<Flight> flight;
    std::vector<std::optional<PaintedBand>> painted;  // each written by the worker that took it
    // Guarded by the service's mutex:
    std::size_t taken = 0;
    std::size_t done = 0;
    std::exception_ptr failure = nullptr;  // the first failure
  };
  using Flights = std::vector<std::shared_ptr<Flight>>;
  using Queue = std::list<std::shared_ptr<Flight>>;  // moving between them needs no memory

  bool is_quick_to_identify(const TilePlan& plan, std::uint64_t cost) const;
  std::string identify(const TilePlan& plan);
  void start_workers(std::vector<std::unique_ptr<MaskRenderer>> renderers);
  void stop_workers();
  void work(TilePainter& painter);
  /// Places the labels of tiles that wait for them, until the service stops.
  void place_labels();
  bool has_labels(const TilePlan& plan) const;
  /// The next work of a worker: flights to draw together, or else bands to help with.
  struct Work {
    Flights flights;
    std::shared_ptr<Bands> bands;
  };
  /// Takes up to `most` flights; false when the service stops.
  bool take(std::size_t most, Work& work);
  /// Waits until there is something to take, and answers what has waited too long for its labels.
  void wait_for_work(std::unique_lock<std::mutex>& lock);
  bool may_take_dear() const;
  Queue& queue_of(Cost cost) { return cost == Cost::cheap ? queue_ : dear_queue_; }
  /// How many waiting tiles one worker should take, so that all workers get some.
  std::size_t share_of_queue() const;
  /// Call these five with the mutex locked.
  /// Queues for a worker `placed` and all waiting tiles whose labels have been placed by now.
  void queue_placed(const std::shared_ptr<Flight>& placed);
  /// Removes and returns a tile that has waited too long for its labels; null if there is none.
  std::shared_ptr<Flight> take_late();
  Ticket join(const std::shared_ptr<Flight>& flight, Clock::time_point now, Asker asker) const;
  /// Whether it was waiting: no worker will tell what became of it.
  bool give_up(const std::shared_ptr<Flight>& flight);
  void forget(const std::shared_ptr<Flight>& flight);
  void draw(TilePainter& painter, const Flights& flights);
  void answer(TilePainter& painter, const Flights& flights);
  std::vector<TileAnswer> paint(TilePainter& painter, const Flights& flights);
  std::vector<std::optional<PaintedTile>> paint_tiles(TilePainter& painter, const Flights& flights);
  PaintJob job_of(const std::shared_ptr<Flight>& flight);
  /// Whether the tile still has to be drawn, once its fingerprint is known.
  bool is_wanted(const std::shared_ptr<Flight>& flight, const std::string& fingerprint);
  static TileAnswer answer_of(const Flight& flight, std::optional<PaintedTile> tile);
  std::optional<PaintedTile> paint_in_bands(TilePainter& painter,
                                            const std::shared_ptr<Flight>& flight);
  /// Paints bands that no worker has taken yet.
  void help(TilePainter& painter, const std::shared_ptr<Bands>& bands);
  std::optional<std::size_t> take_band(Bands& bands);
  static void refuse_damaged(const Flights& flights, std::vector<TileAnswer>& answers);
  /// Answers all clients that have not been answered.
  void land(const std::shared_ptr<Flight>& flight, TileAnswer answer);
  void tell(const TileAnswer& answer) const;

  const TileServiceOptions options_;
  MaskRenderer& renderer_;  // the first one; its worker lives until the service ends
  const std::string renderer_name_;
  const std::string renderer_identity_;
  const std::shared_ptr<FeatureClassCache> classes_;
  const std::size_t workers_;
  std::vector<std::thread> threads_;
  std::thread placer_;

  std::mutex identifying_;  // guards the following, which only compute fingerprints
  std::vector<std::unique_ptr<TilePainter>> idle_identifiers_;

  mutable std::mutex mutex_;  // guards everything below
  std::condition_variable wake_;
  std::condition_variable band_done_;
  std::deque<std::shared_ptr<Bands>> bands_;  // those with bands not yet taken
  Queue queue_;
  Queue dear_queue_;
  std::condition_variable labels_wanted_;
  Queue awaiting_labels_;  // of either cost
  bool is_placing_ = false;
  std::size_t drawing_ = 0;       // tiles that workers have taken
  std::size_t dear_drawing_ = 0;  // the expensive ones among these
  std::unordered_map<std::string, std::shared_ptr<Flight>> flights_;  // queued or being drawn
  bool is_stopping_ = false;
};

}  // namespace trapeze
