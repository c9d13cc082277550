#include "core/io/load/load_layer.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "core/io/load/bounded_queue.h"
#include "core/io/load/feature_builder.h"
#include "core/io/source/attribute_reader.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/source_name.h"

namespace trapeze {
namespace {

using Batch = std::vector<FeatureJob>;

// Large enough that handing over costs nothing, small enough that the end comes evenly; a polygon
// of more than that is a batch of its own.
constexpr std::size_t kBatchBytes = std::size_t{1} << 20;
constexpr std::size_t kBatchFeatures = 2048;
constexpr std::size_t kWaitingBatchesPerBuilder = 4;
constexpr unsigned kMaxThreads = 256;

// Builds batches, on threads of its own or, if there is to be only one thread, at once.
class BuilderPool {
 public:
  BuilderPool(unsigned threads, const FeatureSource& source, const LayerOptions& generalization)
      : queue_(kWaitingBatchesPerBuilder * threads) {
    for (unsigned i = 0; i < threads; ++i) builders_.emplace_back(source, generalization);
    if (threads == 1) return;
    for (FeatureBuilder& builder : builders_) {
      threads_.emplace_back([this, &builder] { work(builder); });
    }
  }

  ~BuilderPool() {
    queue_.abandon();
    for (std::thread& thread : threads_) thread.join();
  }

  BuilderPool(const BuilderPool&) = delete;
  BuilderPool& operator=(const BuilderPool&) = delete;

  // False if building has failed: there is no use in reading on.
  bool add(Batch batch) {
    if (!threads_.empty()) return queue_.push(std::move(batch));
    for (const FeatureJob& job : batch) builders_.front().build(job);
    return true;
  }

  // Waits until all is built; rethrows what stopped a builder.
  std::vector<FeatureBuilder>& finish() {
    queue_.close();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
    if (failure_ != nullptr) std::rethrow_exception(failure_);
    return builders_;
  }

 private:
  void work(FeatureBuilder& builder) {
    try {
      while (const std::optional<Batch> batch = queue_.pop()) {
        for (const FeatureJob& job : *batch) builder.build(job);
      }
    } catch (...) {
      const std::lock_guard lock(failure_mutex_);
      if (failure_ == nullptr) failure_ = std::current_exception();
      queue_.abandon();
    }
  }

  BoundedQueue<Batch> queue_;
  std::vector<FeatureBuilder> builders_;
  std::vector<std::thread> threads_;
  std::mutex failure_mutex_;
  std::exception_ptr failure_;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Reads the source on the calling thread and hands its polygons to the pool.
class Loader {
 public:
  Loader(FeatureSource& source, const LoadOptions& options, BuilderPool& pool)
      : source_(source), options_(options), pool_(pool), attributes_(options.selection.attributes) {
    for (const SourceLayer& layer : source.layers()) {
      attributes_.add_layer(*layer.layer->GetLayerDefn());
    }
    if (const std::vector<std::string> missing = attributes_.missing(); !missing.empty()) {
      throw SourceError("has no attribute \"" + missing.front() + "\"");
    }
    table_ = FeatureTable(attributes_.fields());
  }

  void read_all() {
    SourceFeature next;
    while (source_.next(next)) {
      take(next, features_++);
      if (!is_full()) continue;
      if (!hand_over()) return;
      if (options_.progress) options_.progress(source_.progress());
    }
    hand_over();
  }

  std::size_t features() const { return features_; }
  std::size_t other_geometry() const { return other_geometry_; }
  const BuildTally& tally() const { return tally_; }
  FeatureTable take_table() { return std::move(table_); }

 private:
  void take(SourceFeature& next, std::size_t order) {
    if (next.layer == nullptr) {
      ++other_geometry_;
      return;
    }
    std::unique_ptr<OGRGeometry> geometry(next.feature->StealGeometry(next.layer->geometry_field));
    if (geometry == nullptr && !next.failure.empty()) {
      tally_.skip(order, next.feature->GetFID(), next.failure);
    } else if (geometry == nullptr || !has_polygons(*geometry)) {
      ++other_geometry_;
    } else {
      const std::int64_t id = next.feature->GetFID();
      if (!next.failure.empty()) tally_.remark(order, id, "read, but: " + next.failure);
      const std::uint32_t row =
          table_.append(id, attributes_.read(*next.feature, next.layer_index));
      batch_bytes_ += geometry->WkbSize();
      batch_.push_back({order, row, id, next.layer_index, std::move(geometry)});
    }
  }

  bool is_full() const { return batch_bytes_ >= kBatchBytes || batch_.size() >= kBatchFeatures; }

  bool hand_over() {
    batch_bytes_ = 0;
    return pool_.add(std::exchange(batch_, {}));
  }

  FeatureSource& source_;
  const LoadOptions& options_;
  BuilderPool& pool_;
  AttributeReader attributes_;
  FeatureTable table_;
  Batch batch_;
  std::size_t batch_bytes_ = 0;
  std::size_t features_ = 0;
  std::size_t other_geometry_ = 0;
  BuildTally tally_;  // of features that never reached a builder
};

void add_sums(const BuildTally& tally, LoadReport& report) {
  report.loaded += tally.loaded;
  report.empty += tally.empty;
  report.skipped += tally.skipped;
  report.polygons += tally.polygons;
  report.rings += tally.rings;
  report.source_vertices += tally.source_vertices;
  report.vertices += tally.vertices;
  report.collapsed_rings += tally.collapsed_rings;
  report.repaired += tally.repaired;
  for (const auto count : kCoverageCounts) report.coverage.*count += tally.coverage.*count;
}

void sort_by_order(std::vector<OrderedNote>& notes) {
  std::stable_sort(notes.begin(), notes.end(),
                   [](const OrderedNote& a, const OrderedNote& b) { return a.order < b.order; });
}

// Every tally kept its first remarks, so the first ones of all are among them.
std::vector<FeatureNote> join_notes(const std::vector<const BuildTally*>& tallies) {
  std::vector<OrderedNote> remarks;
  std::vector<OrderedNote> notes;
  for (const BuildTally* tally : tallies) {
    remarks.insert(remarks.end(), tally->remarks.begin(), tally->remarks.end());
    notes.insert(notes.end(), tally->skips.begin(), tally->skips.end());
  }
  sort_by_order(remarks);
  remarks.resize(std::min(remarks.size(), BuildTally::kMaxRemarks));
  notes.insert(notes.end(), remarks.begin(), remarks.end());
  sort_by_order(notes);
  std::vector<FeatureNote> result;
  for (OrderedNote& note : notes) result.push_back(std::move(note.note));
  return result;
}

void fill_report(const Loader& loader, const std::vector<FeatureBuilder>& builders,
                 const FeatureSource& source, LoadReport& report) {
  report.driver = source.driver();
  report.features = loader.features() + source.passed_over();
  report.other_geometry = loader.other_geometry() + source.passed_over();
  std::vector<const BuildTally*> tallies = {&loader.tally()};
  for (const FeatureBuilder& builder : builders) tallies.push_back(&builder.tally());
  for (const BuildTally* tally : tallies) add_sums(*tally, report);
  report.notes = join_notes(tallies);
}

std::unique_ptr<Layer> join_layer(std::vector<FeatureBuilder>& builders, FeatureTable table) {
  std::vector<LayerBuilder> parts;
  for (FeatureBuilder& builder : builders) parts.push_back(builder.take_builder());
  return LayerBuilder::join(parts, std::move(table));
}

unsigned thread_count(const LoadOptions& options) {
  const unsigned wanted =
      options.threads != 0 ? options.threads : std::thread::hardware_concurrency();
  return std::clamp(wanted, 1u, kMaxThreads);
}

LoadedLayer load(FeatureSource& source, const LoadOptions& options,
                 std::chrono::steady_clock::time_point start) {
  LoadedLayer loaded;
  BuilderPool pool(thread_count(options), source, options.generalization);
  Loader loader(source, options, pool);
  loader.read_all();
  loaded.report.read_seconds = seconds_since(start);
  std::vector<FeatureBuilder>& builders = pool.finish();
  if (options.generalization.coverage != CoverageMode::off) {
    build_waiting(builders, options.generalization);
  }
  fill_report(loader, builders, source, loaded.report);
  loaded.layer = join_layer(builders, loader.take_table());
  if (options.progress) options.progress(1);
  loaded.report.total_seconds = seconds_since(start);
  return loaded;
}

}  // namespace

LoadedLayer load_layer(const std::string& path, const LoadOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  FeatureSource source(path, options.selection);
  try {
    LoadedLayer loaded = load(source, options, start);
    loaded.report.path = name_of_source(path);
    return loaded;
  } catch (const SourceError& error) {
    throw std::runtime_error(name_of_source(path) + ": " + error.what());
  }
}

}  // namespace trapeze
