// Draws tiles on worker threads: a plan in, bytes out. Knows nothing of HTTP.
//
// Thread-safety: all methods may be called from any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "render/coverage.h"
#include "server/tile_painter.h"
#include "server/tile_plan.h"

namespace trapeze {

struct TileServiceOptions {
  std::size_t queue = 256;                     // distinct tiles that may wait for a worker
  std::chrono::milliseconds deadline{10'000};  // from submission to the end of drawing
};

enum class TileOutcome {
  drawn,
  saturated,  // the queue is full, or the service is stopping: worth asking again
  late,       // past the deadline
  failed,     // an error of ours, which has been logged
};

struct TileAnswer {
  TileOutcome outcome = TileOutcome::failed;
  std::shared_ptr<const std::string> png;  // null unless drawn
  PaintTimes times;
};

class TileService {
 public:
  using Callback = std::function<void(const TileAnswer&)>;

  /// Starts one worker for each renderer, of which there is at least one.
  TileService(const TileServiceOptions& options,
              std::vector<std::unique_ptr<CoverageRenderer>> renderers);
  /// Ends what is being drawn; what waits is answered as saturated.
  ~TileService();
  TileService(const TileService&) = delete;
  TileService& operator=(const TileService&) = delete;

  /// Calls `callback` exactly once: from a worker, or from within this call if the queue is full.
  /// Plans of equal key that are under way together are drawn once.
  void submit(TilePlan plan, Callback callback);

  /// One word for what draws.
  const std::string& renderer_name() const { return renderer_name_; }

 private:
  struct Flight {
    TilePlan plan;
    std::string key;
    TilePainter::Deadline deadline;  // of the last who asked
    std::vector<Callback> callbacks;
  };

  void work(TilePainter& painter);
  /// The next flight to draw; null when the service stops.
  std::shared_ptr<Flight> take();
  TileAnswer draw(TilePainter& painter, Flight& flight);
  void land(Flight& flight, const TileAnswer& answer);

  const TileServiceOptions options_;
  const std::string renderer_name_;
  std::vector<std::thread> threads_;

  std::mutex mutex_;  // guards all below
  std::condition_variable wake_;
  std::deque<std::shared_ptr<Flight>> queue_;
  std::unordered_map<std::string, std::shared_ptr<Flight>> flights_;  // queued or being drawn
  bool is_stopping_ = false;
};

}  // namespace trapeze
