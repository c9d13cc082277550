// The metrics for Prometheus: counts and durations of answers and tiles, and the state of the
// server's parts at the time of the scrape.
//
// Thread-safety: all methods may be called from any thread. Counting takes well under a microsecond
// and no lock that a scrape holds for longer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/data/dataset.h"
#include "server/http/http_server.h"
#include "server/tiles/tile_cache.h"
#include "server/tiles/tile_service.h"

namespace trapeze {

/// The state of the server's parts, reported in addition to the counters.
struct ServerFigures {
  std::shared_ptr<const Dataset> data;  // null: still loading
  TileCache::Figures cache;
  std::size_t cache_budget = 0;  // bytes
  TileService::Figures tiles;
  std::size_t queue_limit = 0;
  std::size_t connections = 0;
  std::uint64_t refused_connections = 0;
  std::string renderer;
  bool is_stopping = false;
};

class Metrics {
 public:
  Metrics();
  ~Metrics();
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  void count(const Answered& answered);
  void count(const TileAnswer& tile);
  /// Counts that reading the layers ended, at the start or later.
  void count_load(bool has_succeeded);

  /// All metrics, in the text format of Prometheus.
  std::string text(const ServerFigures& figures) const;

  static constexpr std::string_view kContentType = "text/plain; version=0.0.4; charset=utf-8";

 private:
  struct Counted;
  std::unique_ptr<Counted> counted_;
};

}  // namespace trapeze
