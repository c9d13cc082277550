// Creates documents in a thread of its own, so that neither sockets nor tiles wait for a legend,
// and caches the most recent ones.
//
// Thread-safety: all methods may be called from any thread.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "server/base/lru_map.h"
#include "server/base/result.h"
#include "server/data/dataset.h"
#include "server/documents/document.h"

namespace trapeze {

class DocumentWorker {
 public:
  using Answer = Result<std::shared_ptr<const Document>>;
  using Callback = std::function<void(Answer)>;
  using Make = std::function<Result<Document>()>;

  /// Throws std::system_error if its thread cannot be started.
  DocumentWorker();
  /// Waiting requests are answered with a problem.
  ~DocumentWorker();
  DocumentWorker(const DocumentWorker&) = delete;
  DocumentWorker& operator=(const DocumentWorker&) = delete;

  /// The cached document with that key of that dataset; null if there is none. Drops the documents
  /// of other datasets.
  std::shared_ptr<const Document> find(const std::shared_ptr<const Dataset>& dataset,
                                       const std::string& key);

  /// Creates the document, caches it, and calls `callback` exactly once: from the worker, from
  /// within this call if too many requests wait (503), or from the destructor. If `make` throws,
  /// the error is logged and answered with a problem (500). Documents with an empty key are not
  /// cached.
  void submit(std::shared_ptr<const Dataset> dataset, std::string key, Make make,
              Callback callback);

  static constexpr std::size_t kMostWaiting = 64;
  static constexpr std::size_t kBudget = std::size_t{8} << 20;  // bytes of cached documents

 private:
  struct Order {
    std::shared_ptr<const Dataset> dataset;
    std::string key;
    Make make;
    Callback callback;
  };

  void work();
  std::optional<Order> next_order();
  Answer answer(const Order& order);
  /// Call these two with the mutex locked.
  std::shared_ptr<const Document> find_kept(const std::shared_ptr<const Dataset>& dataset,
                                            const std::string& key);
  void keep(const Order& order, const std::shared_ptr<const Document>& document);

  std::mutex mutex_;  // guards everything below except the thread
  std::condition_variable wake_;
  std::deque<Order> orders_;
  std::weak_ptr<const Dataset> kept_of_;
  LruMap<std::string, std::shared_ptr<const Document>> kept_{kBudget};
  bool is_stopping_ = false;
  std::thread thread_;  // last, as it uses all other members
};

}  // namespace trapeze
