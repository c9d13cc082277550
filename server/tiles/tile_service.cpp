#include "server/tiles/tile_service.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <utility>

namespace trapeze {

TileService::TileService(const TileServiceOptions& options,
                         std::vector<std::unique_ptr<MaskRenderer>> renderers)
    : options_(options),
      renderer_(*renderers.front()),
      renderer_name_(renderer_.name()),
      workers_(renderers.size()) {
  try {
    start_workers(std::move(renderers));
  } catch (...) {
    stop_workers();
    throw;
  }
}

void TileService::start_workers(std::vector<std::unique_ptr<MaskRenderer>> renderers) {
  const auto classes = TilePainter::new_class_cache();
  for (auto& renderer : renderers) {
    threads_.emplace_back(
        [this, painter = TilePainter(std::move(renderer), classes, options_.fonts)]() mutable {
          work(painter);
        });
  }
}

void TileService::stop_workers() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void TileService::submit(TilePlan plan, std::string key, Callback callback) {
  const auto now = TilePainter::Clock::now();
  const auto deadline = now + options_.deadline;
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = flights_.find(key); found != flights_.end() && !is_stopping_) {
      found->second->deadline = deadline;
      found->second->callbacks.push_back(std::move(callback));
      return;
    }
    if (queue_.size() < options_.queue && !is_stopping_) {
      auto flight = std::make_shared<Flight>();
      flight->plan = std::move(plan);
      flight->key = std::move(key);
      flight->submitted = now;
      flight->deadline = deadline;
      flight->callbacks.push_back(std::move(callback));
      flights_.emplace(flight->key, flight);
      queue_.push_back(std::move(flight));
      wake_.notify_one();
      return;
    }
  }
  const TileAnswer saturated{TileOutcome::saturated, {}};
  tell(saturated);
  callback(saturated);
}

TileService::Figures TileService::figures() const {
  const std::lock_guard lock(mutex_);
  return {queue_.size(), flights_.size() - queue_.size()};
}

void TileService::tell(const TileAnswer& answer) const {
  if (options_.observe) options_.observe(answer);
}

void TileService::work(TilePainter& painter) {
  const std::size_t most =
      painter.gains_by_batching() ? std::max<std::size_t>(options_.batch, 1) : 1;
  while (true) {
    const Flights flights = take(most);
    if (flights.empty()) return;
    draw(painter, flights);
  }
}

TileService::Flights TileService::take(std::size_t most) {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [this] { return is_stopping_ || !queue_.empty(); });
  Flights flights;
  if (is_stopping_) return flights;
  const std::size_t count = std::min(most, share_of_queue());
  for (std::size_t i = 0; i < count; ++i) {
    flights.push_back(std::move(queue_.front()));
    queue_.pop_front();
  }
  return flights;
}

std::size_t TileService::share_of_queue() const {
  return (queue_.size() + workers_ - 1) / workers_;
}

// What goes wrong with several tiles is tried again with each alone, so that only the one that is
// to blame fails.
void TileService::draw(TilePainter& painter, const Flights& flights) {
  std::vector<TileAnswer> answers = paint(painter, flights);
  for (std::size_t i = 0; i < flights.size(); ++i) {
    if (flights.size() > 1 && answers[i].outcome == TileOutcome::failed) {
      answers[i] = paint(painter, {flights[i]}).front();
    }
    land(flights[i], answers[i]);
  }
}

std::vector<TileAnswer> TileService::paint(TilePainter& painter, const Flights& flights) {
  std::vector<TilePainter::Job> jobs;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& flight : flights) jobs.push_back({&flight->plan, flight->deadline});
  }
  const auto begin = TilePainter::Clock::now();
  std::vector<TileAnswer> answers;
  // This is the boundary of a request: nothing that goes wrong in one may end the worker.
  try {
    for (auto& tile : painter.paint(jobs)) {
      answers.push_back(tile ? TileAnswer{TileOutcome::drawn, std::move(*tile)}
                             : TileAnswer{TileOutcome::late, {}});
    }
    refuse_damaged(flights, answers);
  } catch (const std::exception& error) {
    spdlog::error("tile {}{} cannot be drawn: {}", flights.front()->key,
                  flights.size() > 1 ? " or one drawn with it" : "", error.what());
    answers.assign(flights.size(), TileAnswer{});
  }
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const auto waited = begin - flights[i]->submitted;
    answers[i].tile.times.queue_ms = std::chrono::duration<double, std::milli>(waited).count();
  }
  return answers;
}

/// What was drawn while a file was cut off may be drawn from zeros.
void TileService::refuse_damaged(const Flights& flights, std::vector<TileAnswer>& answers) {
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const ServedLayer* damaged = flights[i]->plan.damaged_layer();
    if (damaged == nullptr) continue;
    spdlog::error("{} was cut off while it was served; run `trapeze prepare` again",
                  damaged->report.path);
    answers[i] = TileAnswer{};
  }
}

void TileService::land(const std::shared_ptr<Flight>& flight, const TileAnswer& answer) {
  std::vector<Callback> callbacks;
  {
    const std::lock_guard lock(mutex_);
    const bool has_time = flight->deadline > TilePainter::Clock::now() && !is_stopping_;
    if (answer.outcome == TileOutcome::late && has_time) {
      queue_.push_front(flight);
      wake_.notify_one();
      return;
    }
    flights_.erase(flight->key);
    callbacks.swap(flight->callbacks);
  }
  tell(answer);
  for (const Callback& callback : callbacks) callback(answer);
}

TileService::~TileService() {
  stop_workers();
  while (!queue_.empty()) {
    const auto flight = std::move(queue_.front());
    queue_.pop_front();
    land(flight, {TileOutcome::saturated, {}});
  }
}

}  // namespace trapeze
