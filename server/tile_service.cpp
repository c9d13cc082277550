#include "server/tile_service.h"

#include <spdlog/spdlog.h>

#include <exception>
#include <utility>

namespace trapeze {

TileService::TileService(const TileServiceOptions& options,
                         std::vector<std::unique_ptr<CoverageRenderer>> renderers)
    : options_(options), renderer_name_(renderers.front()->name()) {
  for (auto& renderer : renderers) {
    threads_.emplace_back(
        [this, painter = TilePainter(std::move(renderer))]() mutable { work(painter); });
  }
}

void TileService::submit(TilePlan plan, Callback callback) {
  std::string key = plan.key();
  const auto deadline = TilePainter::Clock::now() + options_.deadline;
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
      flight->deadline = deadline;
      flight->callbacks.push_back(std::move(callback));
      flights_.emplace(flight->key, flight);
      queue_.push_back(std::move(flight));
      wake_.notify_one();
      return;
    }
  }
  callback({TileOutcome::saturated, nullptr, {}});
}

void TileService::work(TilePainter& painter) {
  while (const auto flight = take()) land(*flight, draw(painter, *flight));
}

std::shared_ptr<TileService::Flight> TileService::take() {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [this] { return is_stopping_ || !queue_.empty(); });
  if (is_stopping_) return nullptr;
  auto flight = std::move(queue_.front());
  queue_.pop_front();
  return flight;
}

TileAnswer TileService::draw(TilePainter& painter, Flight& flight) {
  const auto deadline = [&] {
    const std::lock_guard lock(mutex_);
    return flight.deadline;
  }();
  // This is the boundary of a request: nothing that goes wrong in one may end the worker.
  try {
    auto tile = painter.paint(flight.plan, deadline);
    if (!tile) return {TileOutcome::late, nullptr, {}};
    return {TileOutcome::drawn, std::make_shared<const std::string>(std::move(tile->png)),
            tile->times};
  } catch (const std::exception& error) {
    spdlog::error("tile {} cannot be drawn: {}", flight.key, error.what());
  }
  return {};
}

void TileService::land(Flight& flight, const TileAnswer& answer) {
  std::vector<Callback> callbacks;
  {
    const std::lock_guard lock(mutex_);
    flights_.erase(flight.key);
    callbacks.swap(flight.callbacks);
  }
  for (const Callback& callback : callbacks) callback(answer);
}

TileService::~TileService() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  while (!queue_.empty()) {
    const auto flight = std::move(queue_.front());
    queue_.pop_front();
    land(*flight, {TileOutcome::saturated, nullptr, {}});
  }
}

}  // namespace trapeze
