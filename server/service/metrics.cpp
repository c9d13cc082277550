#include "server/service/metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <iterator>
#include <utility>
#include <vector>

#include "server/base/build_id.h"
#include "server/base/url.h"
#include "server/documents/routes.h"
#include "server/service/process_figures.h"
#include "server/tiles/paint_stages.h"

namespace trapeze {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;
using Labels = std::vector<ClientMetric::Label>;

constexpr std::array<int, 16> kStatuses = {200, 201, 204, 304, 400, 403, 404, 405,
                                           413, 414, 429, 431, 500, 503, 504, 0};
constexpr std::size_t kOutcomes = kTileOutcomeNames.names().size();

// In seconds: from a cached answer up to the deadline.
const prometheus::Histogram::BucketBoundaries kBuckets = {
    0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025,
    0.05,   0.1,     0.25,   0.5,   1,      2.5,   5,    10};

template <typename Range, typename Value>
std::size_t place_in(const Range& known, const Value& value) {
  const auto found = std::ranges::find(known, value);
  return static_cast<std::size_t>(
      std::min<std::ptrdiff_t>(found - known.begin(), std::ssize(known) - 1));
}

/// The metrics of one family. Each is created when first needed; later look-ups take no lock.
template <typename Metric, std::size_t size>
class Lazily {
 public:
  template <typename Make>
  Metric& get(std::size_t place, Make make) {
    Metric* metric = metrics_[place].load(std::memory_order_acquire);
    if (metric == nullptr) {
      metric = &make();  // if two threads come here, the family returns the same one
      metrics_[place].store(metric, std::memory_order_release);
    }
    return *metric;
  }

 private:
  std::array<std::atomic<Metric*>, size> metrics_{};
};

double unix_time() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Families that report a current state instead of counting.
class Snapshot {
 public:
  MetricFamily& family(const char* name, const char* help, MetricType type) {
    families_.push_back({name, help, type, {}});
    return families_.back();
  }
  static void add(MetricFamily& family, Labels labels, double value) {
    ClientMetric metric;
    metric.label = std::move(labels);
    if (family.type == MetricType::Counter) {
      metric.counter.value = value;
    } else {
      metric.gauge.value = value;
    }
    family.metric.push_back(std::move(metric));
  }
  void gauge(const char* name, const char* help, double value, Labels labels = {}) {
    add(family(name, help, MetricType::Gauge), std::move(labels), value);
  }
  void counter(const char* name, const char* help, double value) {
    add(family(name, help, MetricType::Counter), {}, value);
  }
  std::vector<MetricFamily> take() { return std::move(families_); }

 private:
  std::vector<MetricFamily> families_;
};

void add_tiles(Snapshot& snapshot, const ServerFigures& figures) {
  const auto number = [](auto value) { return static_cast<double>(value); };
  snapshot.counter("trapeze_cache_hits_total", "Tiles that were found in the cache",
                   number(figures.cache.hits));
  snapshot.counter("trapeze_cache_misses_total",
                   "Searches of the cache that found no tile; a request may search twice",
                   number(figures.cache.misses));
  snapshot.gauge("trapeze_cache_bytes", "Memory of the cache that is used",
                 number(figures.cache.bytes));
  snapshot.gauge("trapeze_cache_budget_bytes", "Memory that the cache may use",
                 number(figures.cache_budget));
  snapshot.gauge("trapeze_cache_tiles", "Tiles in the cache", number(figures.cache.tiles));
  snapshot.gauge("trapeze_queue_length", "Tiles that wait for a worker",
                 number(figures.tiles.waiting));
  snapshot.gauge("trapeze_queue_limit", "Tiles that may wait for a worker",
                 number(figures.queue_limit));
  snapshot.gauge("trapeze_tiles_in_flight", "Tiles that workers are drawing",
                 number(figures.tiles.drawing));
}

void add_layers(Snapshot& snapshot, const Dataset& data) {
  struct Figure {
    const char* name;
    const char* help;
    double (*value)(const ServedLayer&);
  };
  static constexpr std::array kFigures = {
      Figure{"trapeze_layer_bytes", "Memory of a layer: geometry, index and attributes",
             [](const ServedLayer& served) { return static_cast<double>(served.memory()); }},
      Figure{"trapeze_layer_vertices", "Vertices of a layer at full detail",
             [](const ServedLayer& served) { return static_cast<double>(served.size().vertices); }},
      Figure{"trapeze_layer_features", "Features of a layer",
             [](const ServedLayer& served) { return static_cast<double>(served.report.loaded); }},
      Figure{"trapeze_layer_skipped_features", "Features of a layer that could not be used",
             [](const ServedLayer& served) { return static_cast<double>(served.report.skipped); }}};
  for (const Figure& figure : kFigures) {
    auto& family = snapshot.family(figure.name, figure.help, MetricType::Gauge);
    for (const ServedLayer& served : data.layers_on_all_grids()) {
      Snapshot::add(family, {{"layer", served.label()}}, figure.value(served));
    }
  }
  snapshot.gauge("trapeze_data_info", "The generation of the data that is served", 1,
                 {{"generation", data.generation()}});
}

void add_process(Snapshot& snapshot) {
  const ProcessFigures process = process_figures();
  const auto number = [](auto value) { return static_cast<double>(value); };
  snapshot.gauge("process_resident_memory_bytes", "Resident memory",
                 number(process.resident_bytes));
  snapshot.gauge("process_resident_memory_peak_bytes", "The most resident memory there ever was",
                 number(process.peak_resident_bytes));
  snapshot.gauge("process_virtual_memory_bytes", "Virtual memory", number(process.virtual_bytes));
  snapshot.gauge("process_open_fds", "Open file descriptors", number(process.open_files));
  snapshot.gauge("process_max_fds", "File descriptors that may be open", number(process.max_files));
  snapshot.counter("process_cpu_seconds_total", "User and system time", process.cpu_seconds);
  snapshot.gauge("process_start_time_seconds", "Start of the process, since 1970",
                 process.start_time);
}

void add_server(Snapshot& snapshot, const ServerFigures& figures) {
  snapshot.gauge("trapeze_ready", "1 if layers are served and the server is not stopping",
                 figures.data != nullptr && !figures.is_stopping ? 1 : 0);
  snapshot.gauge("trapeze_connections", "Connections that are open",
                 static_cast<double>(figures.connections));
  snapshot.counter("trapeze_connections_refused_total", "Connections beyond a limit",
                   static_cast<double>(figures.refused_connections));
  snapshot.gauge("trapeze_renderer_info", "What draws", 1, {{"renderer", figures.renderer}});
  snapshot.gauge("trapeze_build_info", "The program", 1,
                 {{"version", version()}, {"build", build_id()}});
}

}  // namespace

struct Metrics::Counted {
  prometheus::Registry registry;
  prometheus::Family<prometheus::Counter>& answers =
      prometheus::BuildCounter()
          .Name("trapeze_requests_total")
          .Help("Requests that were answered, by the first word of their path and status code")
          .Register(registry);
  prometheus::Family<prometheus::Histogram>& answer_times =
      prometheus::BuildHistogram()
          .Name("trapeze_request_seconds")
          .Help("From reading a request to sending its answer")
          .Register(registry);
  prometheus::Family<prometheus::Counter>& tiles =
      prometheus::BuildCounter()
          .Name("trapeze_tiles_total")
          .Help("Tiles that a worker looked at, by what became of them")
          .Register(registry);
  prometheus::Counter& full_colour_tiles =
      prometheus::BuildCounter()
          .Name("trapeze_tiles_in_full_colour_total")
          .Help("Drawn tiles whose colours do not fit into a palette")
          .Register(registry)
          .Add({});
  prometheus::Family<prometheus::Histogram>& stage_times =
      prometheus::BuildHistogram()
          .Name("trapeze_tile_stage_seconds")
          .Help("Time that drawn tiles spent in each stage, as in Server-Timing")
          .Register(registry);
  prometheus::Family<prometheus::Counter>& loads =
      prometheus::BuildCounter()
          .Name("trapeze_data_loads_total")
          .Help("Attempts to read the layers, at the start and later")
          .Register(registry);
  prometheus::Gauge& is_load_failed =
      prometheus::BuildGauge()
          .Name("trapeze_data_load_failed")
          .Help("1 if the last attempt to read the layers failed, and older ones are served")
          .Register(registry)
          .Add({});
  prometheus::Gauge& loaded_at =
      prometheus::BuildGauge()
          .Name("trapeze_data_loaded_timestamp_seconds")
          .Help("When the layers that are served were read, since 1970; 0 if never")
          .Register(registry)
          .Add({});

  Lazily<prometheus::Counter, kAreas * kStatuses.size()> answer_counters;
  Lazily<prometheus::Histogram, kAreas> answer_histograms;
  std::array<prometheus::Counter*, kOutcomes> tile_counters{};
  std::array<prometheus::Histogram*, kPaintStages.size()> stage_histograms{};
  prometheus::Counter& good_loads = loads.Add({{"result", "succeeded"}});
  prometheus::Counter& bad_loads = loads.Add({{"result", "failed"}});

  Counted() {
    for (const TileOutcome outcome : kTileOutcomeNames.values()) {
      tile_counters[static_cast<std::size_t>(outcome)] =
          &tiles.Add({{"outcome", std::string(kTileOutcomeNames.name_of(outcome))}});
    }
    for (std::size_t i = 0; i < kPaintStages.size(); ++i) {
      stage_histograms[i] = &stage_times.Add({{"stage", kPaintStages[i].name}}, kBuckets);
    }
  }
};

Metrics::Metrics() : counted_(std::make_unique<Counted>()) {}

Metrics::~Metrics() = default;

void Metrics::count(const Answered& answered) {
  const auto target = split_target(answered.request.target);
  const Area area = target ? area_of(target->path) : Area::other;
  const auto route = static_cast<std::size_t>(area);
  const std::size_t status = place_in(kStatuses, answered.response.status);
  Counted& counted = *counted_;
  const std::string route_name(name_of(area));
  counted.answer_counters
      .get(route * kStatuses.size() + status,
           [&]() -> prometheus::Counter& {
             const int code = kStatuses[status];
             return counted.answers.Add(
                 {{"route", route_name}, {"code", code == 0 ? "other" : std::to_string(code)}});
           })
      .Increment();
  counted.answer_histograms
      .get(route,
           [&]() -> prometheus::Histogram& {
             return counted.answer_times.Add({{"route", route_name}}, kBuckets);
           })
      .Observe(answered.duration.count());
}

void Metrics::count(const TileAnswer& tile) {
  counted_->tile_counters[static_cast<std::size_t>(tile.outcome)]->Increment();
  if (tile.outcome != TileOutcome::drawn) return;
  if (!tile.tile.has_palette) counted_->full_colour_tiles.Increment();
  for (std::size_t i = 0; i < kPaintStages.size(); ++i) {
    counted_->stage_histograms[i]->Observe(tile.tile.times.*kPaintStages[i].milliseconds / 1000);
  }
}

void Metrics::count_load(bool has_succeeded) {
  (has_succeeded ? counted_->good_loads : counted_->bad_loads).Increment();
  counted_->is_load_failed.Set(has_succeeded ? 0 : 1);
  if (has_succeeded) counted_->loaded_at.Set(unix_time());
}

std::string Metrics::text(const ServerFigures& figures) const {
  Snapshot snapshot;
  add_tiles(snapshot, figures);
  add_server(snapshot, figures);
  if (figures.data != nullptr) add_layers(snapshot, *figures.data);
  add_process(snapshot);
  std::vector<MetricFamily> families = counted_->registry.Collect();
  std::ranges::move(snapshot.take(), std::back_inserter(families));
  return prometheus::TextSerializer().Serialize(families);
}

}  // namespace trapeze
