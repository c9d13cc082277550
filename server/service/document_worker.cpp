#include "server/service/document_worker.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <utility>

#include "server/base/failure_words.h"

namespace trapeze {
namespace {

Problem too_many() {
  return {503, "The server has more documents to create than it can handle. Try again."};
}

}  // namespace

DocumentWorker::DocumentWorker() : thread_([this] { work(); }) {}

DocumentWorker::~DocumentWorker() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
  for (const Order& order : orders_) order.callback(too_many());
}

std::shared_ptr<const Document> DocumentWorker::find(const std::shared_ptr<const Dataset>& dataset,
                                                     const std::string& key) {
  const std::lock_guard lock(mutex_);
  return find_kept(dataset, key);
}

void DocumentWorker::submit(std::shared_ptr<const Dataset> dataset, std::string key, Make make,
                            Callback callback) {
  {
    const std::lock_guard lock(mutex_);
    if (orders_.size() < kMostWaiting) {
      orders_.push_back({std::move(dataset), std::move(key), std::move(make), std::move(callback)});
      wake_.notify_one();
      return;
    }
  }
  callback(too_many());
}

void DocumentWorker::work() {
  while (const auto order = next_order()) {
    // Callbacks may plan tiles, and memory may run out; then the connection is closed.
    try {
      order->callback(answer(*order));
    } catch (const std::exception& error) {
      log_failure(order->key, error);
    }
  }
}

std::optional<DocumentWorker::Order> DocumentWorker::next_order() {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [this] { return is_stopping_ || !orders_.empty(); });
  if (is_stopping_) return std::nullopt;
  Order order = std::move(orders_.front());
  orders_.pop_front();
  return order;
}

// Several clients may have requested the same document while it was being made.
DocumentWorker::Answer DocumentWorker::answer(const Order& order) {
  if (auto kept = find(order.dataset, order.key)) return kept;
  // Request boundary: an error in one request must not end the worker.
  try {
    auto made = order.make();
    if (!made) return std::move(made).problem();
    auto document = std::make_shared<const Document>(*std::move(made));
    const std::lock_guard lock(mutex_);
    keep(order, document);
    return document;
  } catch (const std::exception& error) {
    spdlog::error(fmt::format("{}: {}", order.key, error.what()));
    return Problem{500, "The document could not be made."};
  }
}

std::shared_ptr<const Document> DocumentWorker::find_kept(
    const std::shared_ptr<const Dataset>& dataset, const std::string& key) {
  if (kept_of_.lock() != dataset) {
    kept_ = LruMap<std::string, std::shared_ptr<const Document>>(kBudget);
    kept_of_ = dataset;
  }
  const auto* kept = key.empty() ? nullptr : kept_.find(key);
  return kept == nullptr ? nullptr : *kept;
}

void DocumentWorker::keep(const Order& order, const std::shared_ptr<const Document>& document) {
  constexpr std::size_t kOverhead = 256;  // approximate, per entry
  if (order.key.empty() || find_kept(order.dataset, order.key) != nullptr) return;
  kept_.insert(order.key, document, kOverhead + order.key.size() + document->bytes.size());
}

}  // namespace trapeze
