// Draws tiles on worker threads: a plan in, bytes out. Knows nothing of HTTP.
//
// Dear tiles have a queue of their own, and half of the workers at most: cheap ones go on being
// drawn beside them. Large tiles are drawn in bands, with the help of workers that have nothing
// else to do. Labels that nobody has asked for yet are placed by a thread of its own, which may
// take longer than anybody waits: meanwhile tiles with such labels wait, and no worker does.
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
  kept,       // found by its fingerprint, and not drawn
  held,       // by all who asked: there are no bytes
  saturated,  // the queue is full, or the service is stopping: worth asking again
  late,       // past the deadline, before it was drawn or while it was
  withdrawn,  // by who asked
  placing,    // past the deadline, while its labels were being placed: worth asking again
  damaged,    // of a file that is cut off or written into, which has been logged
  failed,     // an error of ours, which has been logged
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

  /// Whether the tile is known by its fingerprint.
  bool is_known() const { return outcome <= TileOutcome::held; }
};

struct TileServiceOptions {
  // Distinct tiles that may wait for a worker, of the cheap ones and of the dear ones each.
  std::size_t queue = defaults::kQueue;
  std::chrono::milliseconds deadline = defaults::kDeadline;  // from submission to the answer
  // Tiles that a worker draws in one pass, at most, if that is faster than one by one. None is
  // waited for; but a tile waits until those of its pass are drawn too.
  std::size_t batch = defaults::kBatch;
  // For marks.
  std::shared_ptr<const Fonts> fonts = std::make_shared<const Fonts>();
  std::shared_ptr<LabelBook> labels = std::make_shared<LabelBook>();
  // Finds a tile that was drawn before by its fingerprint; its bytes are null if it is not there.
  std::function<TileCache::Tile(const std::string& fingerprint)> find_kept = {};
  // Told once of every tile, however many asked for it, from whatever thread answers.
  std::function<void(const TileAnswer&)> observe = {};
};

class TileService {
 public:
  using Clock = std::chrono::steady_clock;
  using Callback = std::function<void(const TileAnswer&)>;
  /// Whether who asks has the tile of that fingerprint already, and needs no bytes. Called from a
  /// worker with the service locked.
  using Holds = std::function<bool(const std::string& fingerprint)>;
  /// Those that are not cheap wait apart. The memory that a giant one took is given back at once.
  enum class Cost { cheap, dear, giant };

  struct Order {
    TilePlan plan;
    std::string key;  // the plan's
    Cost cost = Cost::cheap;
    /// Of a tile that is not to be drawn if its fingerprint is found to be kept, or held by all who
    /// ask. False: it is drawn whatever its fingerprint is.
    bool may_be_known = true;
  };

 private:
  struct Flight;

 public:
  /// Of one who asked.
  class Ticket {
    friend class TileService;
    std::weak_ptr<Flight> flight_;
    std::size_t number_ = 0;
  };

  /// Starts one worker for each renderer, of which there is at least one. Throws std::system_error
  /// if a thread cannot be started.
  TileService(TileServiceOptions options, std::vector<std::unique_ptr<MaskRenderer>> renderers);
  /// What waits is answered as saturated, what is being drawn as late as soon as that is noticed.
  ~TileService();
  TileService(const TileService&) = delete;
  TileService& operator=(const TileService&) = delete;

  /// Calls `callback` exactly once: from a worker, or from within this call if the queue is full,
  /// or from within withdraw(). Plans of equal key that are under way together are drawn once. An
  /// empty `holds` holds nothing. Throws std::bad_alloc, and never calls back, if there is no
  /// memory to wait.
  Ticket submit(Order order, Callback callback, Holds holds = {});

  /// What submit() would answer a plan of that cost which need not be drawn, found within this call
  /// where that takes less time than to hand it to a worker: a tenth of a millisecond at most.
  /// Nothing if it has to be drawn, and for all others, to be submitted: those of many trapezoids,
  /// in several parts, with marks, with labels that have not been placed, in classes that no tile
  /// of late was in, of a file that was truncated.
  std::optional<TileAnswer> answer_at_once(const TilePlan& plan, std::uint64_t cost,
                                           const Holds& holds);

  /// Answers this one who asked, if that has not been done; what nobody else asked for is not drawn
  /// any further.
  void withdraw(const Ticket& ticket);

  /// One word for what draws.
  const std::string& renderer_name() const { return renderer_name_; }

  /// Places the labels that layers have by their configuration alone, each layer for itself, so
  /// that no tile has to wait for that.
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

  /// Releases what the renderers keep for a mesh. Call it when nothing is going to draw it any
  /// more: what is drawn later would be kept again.
  void forget(std::uint64_t mesh_id) { renderer_.forget(mesh_id); }

 private:
  struct Asker {
    Callback callback;  // empty: withdrew
    Holds holds;
  };
  struct Flight {
    Order order;
    Clock::time_point submitted;
    Cancellation cancellation;  // at the deadline of the last who asked
    std::vector<Asker> askers;
    std::size_t wanted = 0;  // askers that did not withdraw
    TileCache::Tile kept;    // by the worker that draws it, as it was found
  };
  /// The bands of a large tile.
  struct Bands {
    std::shared_ptr<Flight> flight;
    std::vector<std::optional<PaintedBand>> painted;  // each by who has taken it
    // Guarded by the mutex of the service:
    std::size_t taken = 0;
    std::size_t done = 0;
    std::exception_ptr failure = nullptr;  // of the first that failed
  };
  using Flights = std::vector<std::shared_ptr<Flight>>;
  using Queue = std::deque<std::shared_ptr<Flight>>;

  bool is_quick_to_identify(const TilePlan& plan, std::uint64_t cost) const;
  std::string identify(const TilePlan& plan);
  void start_workers(std::vector<std::unique_ptr<MaskRenderer>> renderers);
  void stop_workers();
  void work(TilePainter& painter);
  /// Places the labels of what waits for them, until the service stops.
  void place_labels();
  bool has_labels(const TilePlan& plan) const;
  /// What a worker is to do next: flights to draw together, or else bands to help with.
  struct Work {
    Flights flights;
    std::shared_ptr<Bands> bands;
  };
  /// Of up to so many flights; false when the service stops.
  bool take(std::size_t most, Work& work);
  /// Waits until there is something to take, and answers what has waited too long for its labels.
  void wait_for_work(std::unique_lock<std::mutex>& lock);
  bool may_take_dear() const;
  Queue& queue_of(Cost cost) { return cost == Cost::cheap ? queue_ : dear_queue_; }
  /// How many of those that wait one worker should take, so that all workers have some.
  std::size_t share_of_queue() const;
  /// The five below are called with the mutex locked.
  /// What waits for labels that are there by now, and `placed`, waits for a worker.
  void queue_placed(const std::shared_ptr<Flight>& placed);
  /// One that has waited too long for its labels, and does not any more; null if there is none.
  std::shared_ptr<Flight> take_late();
  Ticket join(const std::shared_ptr<Flight>& flight, Clock::time_point now, Asker asker) const;
  void give_up(const std::shared_ptr<Flight>& flight);
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
  /// Paints bands that nobody has taken yet.
  void help(TilePainter& painter, const std::shared_ptr<Bands>& bands);
  std::optional<std::size_t> take_band(Bands& bands);
  static void refuse_damaged(const Flights& flights, std::vector<TileAnswer>& answers);
  /// Answers all who asked and have not been answered.
  void land(const std::shared_ptr<Flight>& flight, TileAnswer answer);
  void tell(const TileAnswer& answer) const;

  const TileServiceOptions options_;
  MaskRenderer& renderer_;  // the first; its worker lives until the service ends
  const std::string renderer_name_;
  const std::string renderer_identity_;
  const std::shared_ptr<FeatureClassCache> classes_;
  const std::size_t workers_;
  std::vector<std::thread> threads_;
  std::thread placer_;

  std::mutex identifying_;  // guards those below, which find fingerprints and draw nothing
  std::vector<std::unique_ptr<TilePainter>> idle_identifiers_;

  mutable std::mutex mutex_;  // guards all below
  std::condition_variable wake_;
  std::condition_variable band_done_;
  std::deque<std::shared_ptr<Bands>> bands_;  // those of which not all have been taken
  Queue queue_;
  Queue dear_queue_;
  std::condition_variable labels_wanted_;
  Queue awaiting_labels_;  // of either cost
  bool is_placing_ = false;
  std::size_t drawing_ = 0;       // tiles that workers have taken
  std::size_t dear_drawing_ = 0;  // the dear ones of these
  std::unordered_map<std::string, std::shared_ptr<Flight>> flights_;  // queued or being drawn
  bool is_stopping_ = false;
};

}  // namespace trapeze
