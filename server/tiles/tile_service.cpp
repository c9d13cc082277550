#include "server/tiles/tile_service.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "server/base/failure_words.h"
#include "server/base/heap.h"
#include "server/tiles/tile_painter.h"

namespace trapeze {
namespace {

// If notifying one client fails, usually for lack of memory, the others must still be answered.
template <class Action>
void attempt(const Action& tell, std::string_view failure = "a tile cannot be answered") {
  try {
    tell();
  } catch (const std::exception& error) {
    log_failure(failure, error);
  }
}

// In units of drawing_cost(): a tile of a few thousand trapezoids, which takes about 100
// microseconds.
constexpr std::uint64_t kQuickToIdentify = 30'000;

/// Takes the place of a renderer where tiles are only identified.
class NoRenderer final : public MaskRenderer {
 public:
  explicit NoRenderer(std::string identity) : identity_(std::move(identity)) {}

  DrawTimes draw(std::span<const MaskTask> /*tasks*/) override {
    throw std::logic_error("what identifies tiles does not draw");
  }
  std::string_view name() const override { return "none"; }
  std::string description() const override { return identity_; }

 private:
  std::string identity_;
};

// How often tiles that wait for their labels are checked against their deadline.
constexpr auto kLookForLate = std::chrono::milliseconds(50);

/// Rules that name more features take too long to look up.
constexpr std::size_t kFewIds = 1000;

}  // namespace

TileService::TileService(TileServiceOptions options,
                         std::vector<std::unique_ptr<MaskRenderer>> renderers)
    : options_(std::move(options)),
      renderer_(*renderers.front()),
      renderer_name_(renderer_.name()),
      renderer_identity_(renderer_.identity()),
      classes_(TilePainter::new_class_cache()),
      workers_(renderers.size()) {
  try {
    start_workers(std::move(renderers));
  } catch (...) {
    stop_workers();
    throw;
  }
}

void TileService::start_workers(std::vector<std::unique_ptr<MaskRenderer>> renderers) {
  for (auto& renderer : renderers) {
    threads_.emplace_back(
        [this, painter = TilePainter(std::move(renderer), classes_, options_.fonts,
                                     options_.labels)]() mutable { work(painter); });
  }
  placer_ = std::thread([this] { place_labels(); });
}

void TileService::stop_workers() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
    for (const auto& [key, flight] : flights_) flight->cancellation.cancel();
  }
  wake_.notify_all();
  labels_wanted_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  if (placer_.joinable()) placer_.join();
}

bool TileService::has_labels(const TilePlan& plan) const {
  return options_.labels->has_placed({*plan.dataset, plan.labels, plan.view, plan.scale});
}

void TileService::place_labels() {
  std::unique_lock lock(mutex_);
  while (true) {
    labels_wanted_.wait(lock, [this] { return is_stopping_ || !awaiting_labels_.empty(); });
    if (is_stopping_) return;
    const std::shared_ptr<Flight> flight = awaiting_labels_.front();
    is_placing_ = true;
    lock.unlock();
    // If it fails, for lack of memory, the worker that draws the tile tries again.
    attempt(
        [&] {
          const TilePlan& plan = flight->order.plan;
          options_.labels->find({*plan.dataset, plan.labels, plan.view, plan.scale});
        },
        "labels cannot be placed");
    lock.lock();
    is_placing_ = false;
    attempt([&] { queue_placed(flight); }, "tiles wait for their labels");
    wake_.notify_all();
  }
}

bool TileService::is_placing() const {
  const std::lock_guard lock(mutex_);
  return is_placing_ || !awaiting_labels_.empty();
}

void TileService::queue_placed(const std::shared_ptr<Flight>& placed) {
  for (auto flight = awaiting_labels_.begin(); flight != awaiting_labels_.end();) {
    const auto next = std::next(flight);
    if (*flight == placed || has_labels((*flight)->order.plan)) {
      Queue& queue = queue_of((*flight)->order.cost);
      queue.splice(queue.end(), awaiting_labels_, flight);
    }
    flight = next;
  }
}

std::shared_ptr<TileService::Flight> TileService::take_late() {
  if (awaiting_labels_.empty()) return nullptr;
  // The first one has waited longest. The deadline of its first client counts: that of the last one
  // would move on for as long as others request the tile, however long placing takes.
  const auto waited = Clock::now() - awaiting_labels_.front()->submitted;
  if (waited < options_.deadline) return nullptr;
  std::shared_ptr<Flight> flight = std::move(awaiting_labels_.front());
  awaiting_labels_.pop_front();
  return flight;
}

bool TileService::is_quick_to_identify(const TilePlan& plan, std::uint64_t cost) const {
  const auto is_quick = [&](const LayerPaint& paint) {
    const Classing& classing = paint.style.classing;
    const ServedLayer& layer = plan.dataset->layers_on_all_grids()[paint.layer];
    if (layer.parts != nullptr) return false;
    if (classing.is_plain()) return true;
    return classing.ids.size() + classing.highlighted_ids.size() <= kFewIds &&
           classes_->has(layer.revision, classing);
  };
  return cost <= kQuickToIdentify && !plan.debug.any() &&
         std::ranges::all_of(plan.layers, is_quick) && has_labels(plan);
}

std::optional<TileAnswer> TileService::answer_at_once(const TilePlan& plan, std::uint64_t cost,
                                                      const Holds& holds) {
  if (!is_quick_to_identify(plan, cost)) return std::nullopt;
  TileAnswer answer{TileOutcome::held, {identify(plan), nullptr, TileHint::none, {}}};
  const std::string& fingerprint = answer.tile.fingerprint;
  if (plan.damaged_layer() != nullptr) return std::nullopt;
  const TileCache::Tile kept =
      options_.find_kept ? options_.find_kept(fingerprint) : TileCache::Tile{};
  if (kept.bytes != nullptr) {
    answer.outcome = TileOutcome::kept;
    answer.tile.bytes = kept.bytes;
    answer.tile.hint = kept.hint;
  } else if (!holds(fingerprint)) {
    return std::nullopt;
  }
  tell(answer);
  return answer;
}

/// Runs in the calling thread; several threads may call it.
std::string TileService::identify(const TilePlan& plan) {
  std::unique_ptr<TilePainter> identifier;
  {
    const std::lock_guard lock(identifying_);
    if (!idle_identifiers_.empty()) {
      identifier = std::move(idle_identifiers_.back());
      idle_identifiers_.pop_back();
    }
  }
  if (identifier == nullptr) {
    identifier = std::make_unique<TilePainter>(std::make_unique<NoRenderer>(renderer_identity_),
                                               classes_, options_.fonts, options_.labels);
  }
  std::string fingerprint = identifier->identify({&plan});
  const std::lock_guard lock(identifying_);
  idle_identifiers_.push_back(std::move(identifier));
  return fingerprint;
}

TileService::Ticket TileService::submit(Order order, Callback callback, Holds holds) {
  const auto now = Clock::now();
  Asker asker{std::move(callback), std::move(holds)};
  const bool is_placed = has_labels(order.plan);
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = flights_.find(order.key);
        found != flights_.end() && !found->second->cancellation.is_over()) {
      return join(found->second, now, std::move(asker));
    }
    Queue& queue = is_placed ? queue_of(order.cost) : awaiting_labels_;
    if (queue.size() < options_.queue && !is_stopping_) {
      auto flight = std::make_shared<Flight>();
      flight->order = std::move(order);
      flight->submitted = now;
      Ticket ticket = join(flight, now, std::move(asker));
      queue.push_back(flight);
      try {
        flights_.insert_or_assign(flight->order.key, flight);
      } catch (...) {
        queue.pop_back();  // otherwise others would join a flight that no worker takes
        throw;
      }
      if (is_placed) {
        wake_.notify_one();
      } else {
        labels_wanted_.notify_one();
        wake_.notify_all();  // all idle workers look for late tiles: any of them may soon be busy
      }
      return ticket;
    }
  }
  const TileAnswer saturated{TileOutcome::saturated, {}};
  tell(saturated);
  asker.callback(saturated);
  return {};
}

TileService::Ticket TileService::join(const std::shared_ptr<Flight>& flight, Clock::time_point now,
                                      Asker asker) const {
  flight->cancellation.set_deadline(now + options_.deadline);
  flight->askers.push_back(std::move(asker));
  ++flight->wanted;
  Ticket ticket;
  ticket.flight_ = flight;
  ticket.number_ = flight->askers.size() - 1;
  return ticket;
}

void TileService::withdraw(const Ticket& ticket) {
  const auto flight = ticket.flight_.lock();
  if (flight == nullptr) return;
  Callback callback;
  bool was_waiting = false;
  {
    const std::lock_guard lock(mutex_);
    if (ticket.number_ >= flight->askers.size()) return;  // all clients have been answered
    callback = std::exchange(flight->askers[ticket.number_].callback, nullptr);
    if (callback == nullptr) return;
    if (--flight->wanted == 0) was_waiting = give_up(flight);
  }
  if (was_waiting) tell({TileOutcome::withdrawn, {}});
  callback({TileOutcome::withdrawn, {}});
}

// A waiting tile is removed immediately; a worker that is drawing one notices before long.
bool TileService::give_up(const std::shared_ptr<Flight>& flight) {
  flight->cancellation.cancel();
  for (Queue* queue : {&queue_of(flight->order.cost), &awaiting_labels_}) {
    const auto waiting = std::ranges::find(*queue, flight);
    if (waiting == queue->end()) continue;
    queue->erase(waiting);
    forget(flight);
    return true;
  }
  return false;
}

void TileService::forget(const std::shared_ptr<Flight>& flight) {
  const auto found = flights_.find(flight->order.key);
  // A new flight may have started after nobody wanted this one.
  if (found != flights_.end() && found->second == flight) flights_.erase(found);
}

void TileService::place_usual_labels(const std::shared_ptr<const Dataset>& dataset) {
  for (const ServedLayer& layer : dataset->layers()) {
    if (layer.config.style.find({}, ParameterId::label) == nullptr) continue;
    TileRequest request;
    request.layers = {layer.config.name};
    const auto plan = plan_tile(std::move(request), dataset);
    if (!plan) continue;  // the client that requests it gets the problem
    options_.labels->find({*dataset, plan->labels, plan->view, plan->scale});
  }
}

std::uint64_t TileService::cost_of_labels(const TilePlan& plan) const {
  return options_.labels->cost_of({*plan.dataset, plan.labels, plan.view, plan.scale});
}

TileService::Figures TileService::figures() const {
  const std::lock_guard lock(mutex_);
  return {queue_.size() + dear_queue_.size() + awaiting_labels_.size(), drawing_};
}

void TileService::tell(const TileAnswer& answer) const {
  if (options_.observe) attempt([&] { options_.observe(answer); });
}

void TileService::work(TilePainter& painter) {
  const std::size_t most =
      painter.gains_by_batching() ? std::max<std::size_t>(options_.batch, 1) : 1;
  Work work;
  work.flights.reserve(most);  // the maximum, so that taking needs no memory
  while (take(most, work)) {
    if (work.bands != nullptr) {
      help(painter, work.bands);
      if (work.bands->flight->order.cost == Cost::giant) painter.release_memory();
    } else {
      draw(painter, work.flights);
    }
    work.flights.clear();
    work.bands = nullptr;
  }
}

bool TileService::take(std::size_t most, Work& work) {
  Flights& flights = work.flights;
  std::unique_lock lock(mutex_);
  wait_for_work(lock);
  if (is_stopping_) return false;
  if (may_take_dear()) {
    ++dear_drawing_;
    ++drawing_;
    flights.push_back(std::move(dear_queue_.front()));
    dear_queue_.pop_front();
    return true;
  }
  if (queue_.empty()) {
    work.bands = bands_.front();
    return true;
  }
  const std::size_t count = std::min(most, share_of_queue());
  for (std::size_t i = 0; i < count; ++i) {
    flights.push_back(std::move(queue_.front()));
    queue_.pop_front();
  }
  drawing_ += count;
  return true;
}

// What is late comes first: under load, there is always something else to take.
void TileService::wait_for_work(std::unique_lock<std::mutex>& lock) {
  while (!is_stopping_) {
    if (const auto flight = take_late()) {
      lock.unlock();
      land(flight, {TileOutcome::placing, {}});
      lock.lock();
    } else if (!queue_.empty() || may_take_dear() || !bands_.empty()) {
      return;
    } else if (awaiting_labels_.empty()) {
      wake_.wait(lock);
    } else {
      wake_.wait_for(lock, kLookForLate);
    }
  }
}

// A single worker draws cheap tiles first, but not forever.
bool TileService::may_take_dear() const {
  if (dear_queue_.empty() || dear_drawing_ >= std::max<std::size_t>(workers_ / 2, 1)) return false;
  return workers_ > 1 || queue_.empty() ||
         Clock::now() - dear_queue_.front()->submitted > options_.deadline / 4;
}

std::size_t TileService::share_of_queue() const {
  return (queue_.size() + workers_ - 1) / workers_;
}

// Memory may be too short even for answers; the worker continues.
void TileService::draw(TilePainter& painter, const Flights& flights) {
  try {
    answer(painter, flights);
  } catch (const std::exception& error) {
    log_failure("tiles cannot be answered", error);
    for (const auto& flight : flights) land(flight, {});
  }
  const Cost cost = flights.front()->order.cost;
  if (cost == Cost::giant) {
    painter.release_memory();
    return_free_memory();
  }
  const std::lock_guard lock(mutex_);
  drawing_ -= flights.size();
  if (cost != Cost::cheap) {
    --dear_drawing_;
    wake_.notify_one();
  }
}

// If several tiles fail together, each is retried alone, so that only the faulty one fails.
void TileService::answer(TilePainter& painter, const Flights& flights) {
  std::vector<TileAnswer> answers = paint(painter, flights);
  for (std::size_t i = 0; i < flights.size(); ++i) {
    if (flights.size() > 1 && answers[i].outcome == TileOutcome::failed) {
      answers[i] = paint(painter, {flights[i]}).front();
    }
    land(flights[i], std::move(answers[i]));
  }
}

std::vector<TileAnswer> TileService::paint(TilePainter& painter, const Flights& flights) {
  const auto begin = Clock::now();
  std::vector<TileAnswer> answers;
  // Request boundary: an error in one request must not end the worker.
  try {
    auto tiles = paint_tiles(painter, flights);
    for (std::size_t i = 0; i < flights.size(); ++i) {
      answers.push_back(answer_of(*flights[i], std::move(tiles[i])));
    }
    refuse_damaged(flights, answers);
  } catch (const Cancelled&) {
    const TileOutcome outcome = flights.size() > 1 ? TileOutcome::failed : TileOutcome::late;
    answers.assign(flights.size(), TileAnswer{outcome, {}});
  } catch (const std::exception& error) {
    spdlog::error(fmt::format("tile {}{} cannot be drawn: {}", flights.front()->order.key,
                              flights.size() > 1 ? " or one drawn with it" : "", error.what()));
    answers.clear();
    for (const auto& flight : flights) {
      const bool is_damaged = flight->order.plan.damaged_layer() != nullptr;
      answers.push_back({is_damaged ? TileOutcome::damaged : TileOutcome::failed, {}});
    }
  }
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const auto waited = begin - flights[i]->submitted;
    answers[i].tile.times.queue_ms = std::chrono::duration<double, std::milli>(waited).count();
  }
  return answers;
}

// Large tiles are painted one after the other, each with the help of other workers.
std::vector<std::optional<PaintedTile>> TileService::paint_tiles(TilePainter& painter,
                                                                 const Flights& flights) {
  std::vector<PaintJob> jobs;
  for (const auto& flight : flights) {
    if (TilePainter::bands_of(flight->order.plan) == 1) jobs.push_back(job_of(flight));
  }
  std::vector<std::optional<PaintedTile>> small;
  if (!jobs.empty()) small = painter.paint(jobs);
  auto next = small.begin();
  std::vector<std::optional<PaintedTile>> tiles;
  for (const auto& flight : flights) {
    const bool is_large = TilePainter::bands_of(flight->order.plan) > 1;
    tiles.push_back(is_large ? paint_in_bands(painter, flight) : std::move(*next++));
  }
  return tiles;
}

PaintJob TileService::job_of(const std::shared_ptr<Flight>& flight) {
  PaintJob job{&flight->order.plan, &flight->cancellation};
  if (flight->order.may_be_known) {
    job.is_wanted = [this, flight](const std::string& fingerprint) {
      return is_wanted(flight, fingerprint);
    };
  }
  return job;
}

// Once all clients hold the tile, no further client may join that might not.
bool TileService::is_wanted(const std::shared_ptr<Flight>& flight, const std::string& fingerprint) {
  if (options_.find_kept) flight->kept = options_.find_kept(fingerprint);
  if (flight->kept.bytes != nullptr) return false;
  const std::lock_guard lock(mutex_);
  const bool is_held = std::ranges::all_of(flight->askers, [&](const Asker& asker) {
    return asker.callback == nullptr || (asker.holds && asker.holds(fingerprint));
  });
  if (is_held) forget(flight);
  return !is_held;
}

TileAnswer TileService::answer_of(const Flight& flight, std::optional<PaintedTile> tile) {
  if (!tile) return {TileOutcome::late, {}};
  if (tile->bytes != nullptr) return {TileOutcome::drawn, *std::move(tile)};
  if (flight.kept.bytes == nullptr) return {TileOutcome::held, *std::move(tile)};
  tile->bytes = flight.kept.bytes;
  tile->hint = flight.kept.hint;
  return {TileOutcome::kept, *std::move(tile)};
}

std::optional<PaintedTile> TileService::paint_in_bands(TilePainter& painter,
                                                       const std::shared_ptr<Flight>& flight) {
  const PaintJob job = job_of(flight);
  PaintedTile tile;
  tile.fingerprint = painter.identify(job);
  if (job.is_wanted && !job.is_wanted(tile.fingerprint)) return tile;
  const auto bands = std::make_shared<Bands>();
  bands->flight = flight;
  bands->painted.resize(static_cast<std::size_t>(TilePainter::bands_of(flight->order.plan)));
  {
    const std::lock_guard lock(mutex_);
    bands_.push_back(bands);
  }
  wake_.notify_all();
  help(painter, bands);
  {
    std::unique_lock lock(mutex_);
    band_done_.wait(lock, [&] { return bands->done == bands->taken; });
    if (bands->failure != nullptr) std::rethrow_exception(bands->failure);
  }
  std::vector<PaintedBand> painted;
  for (std::optional<PaintedBand>& band : bands->painted) {
    if (!band) return std::nullopt;
    painted.push_back(*std::move(band));
  }
  std::string fingerprint = std::move(tile.fingerprint);
  tile = painter.join(flight->order.plan, painted);
  tile.fingerprint = std::move(fingerprint);
  return tile;
}

// The thread that waits for the bands gets the failure.
void TileService::help(TilePainter& painter, const std::shared_ptr<Bands>& bands) {
  const PaintJob job{&bands->flight->order.plan, &bands->flight->cancellation};
  while (const auto band = take_band(*bands)) {
    std::exception_ptr failure;
    try {
      bands->painted[*band] = painter.paint_band(job, static_cast<int>(*band));
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    ++bands->done;
    if (bands->failure == nullptr) bands->failure = failure;
    band_done_.notify_all();
  }
}

// After a failure, no other band is needed.
std::optional<std::size_t> TileService::take_band(Bands& bands) {
  const std::lock_guard lock(mutex_);
  const bool is_left = bands.taken < bands.painted.size() && bands.failure == nullptr;
  if (is_left) ++bands.taken;
  if (!is_left || bands.taken == bands.painted.size()) {
    std::erase_if(bands_, [&bands](const auto& other) { return other.get() == &bands; });
  }
  return is_left ? std::optional(bands.taken - 1) : std::nullopt;
}

/// Tiles drawn while their file was overwritten may contain anything.
void TileService::refuse_damaged(const Flights& flights, std::vector<TileAnswer>& answers) {
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const ServedLayer* damaged = flights[i]->order.plan.damaged_layer();
    if (damaged == nullptr) continue;
    spdlog::error(fmt::format("{} was modified while it was served; run `trapeze prepare` again",
                              damaged->report.path));
    answers[i] = TileAnswer{TileOutcome::damaged, {}};
  }
}

void TileService::land(const std::shared_ptr<Flight>& flight, TileAnswer answer) {
  std::vector<Asker> askers;
  {
    const std::lock_guard lock(mutex_);
    if (answer.outcome == TileOutcome::late && is_stopping_) {
      answer.outcome = TileOutcome::saturated;
    } else if (answer.outcome == TileOutcome::late && flight->wanted == 0) {
      answer.outcome = TileOutcome::withdrawn;
    }
    forget(flight);
    askers.swap(flight->askers);
  }
  if (askers.empty()) return;  // has already landed
  tell(answer);
  for (const Asker& asker : askers) {
    if (asker.callback != nullptr) attempt([&] { asker.callback(answer); });
  }
}

TileService::~TileService() {
  stop_workers();
  for (Queue* queue : {&queue_, &dear_queue_, &awaiting_labels_}) {
    while (!queue->empty()) {
      const auto flight = std::move(queue->front());
      queue->pop_front();
      land(flight, {TileOutcome::saturated, {}});
    }
  }
}

}  // namespace trapeze
