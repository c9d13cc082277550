#include "core/io/load/feature_pipeline.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <optional>
#include <thread>
#include <utility>

#include "core/borders/coverage_groups.h"
#include "core/borders/gap_closing.h"
#include "core/borders/part_union.h"
#include "core/grid/for_each_in_parallel.h"
#include "core/io/load/bounded_queue.h"
#include "core/sweep/clean_rings.h"

namespace trapeze {
namespace {

// Large enough that passing on a batch costs nothing, small enough that all threads end at about
// the same time. A larger polygon is a batch of its own.
constexpr std::size_t kBatchBytes = std::size_t{1} << 20;
constexpr std::size_t kBatchFeatures = 2048;
constexpr std::size_t kWaitingBatchesPerLane = 4;
constexpr unsigned kMaxThreads = 256;

constexpr std::chrono::milliseconds kProgressInterval{50};
constexpr double kLeastShare = 1e-3;  // of a source; from then on the rest is extrapolated

// The cost of the stages per vertex, measured on land use, buildings, counties and countries.
constexpr double kReadCost = 1;
constexpr double kCloseGapsCost = 15;
constexpr double kGroupCost = 3;
constexpr double kBuildCost = 10;

double work_of(std::span<WaitingFeature* const> task) {
  double vertices = 0;
  for (const WaitingFeature* feature : task) {
    vertices += static_cast<double>(feature->rings.points.size());
  }
  return vertices;
}

/// The groups of features, and each other feature by itself.
std::vector<std::vector<WaitingFeature*>> tasks_of(std::vector<WaitingFeature>& waiting,
                                                   const LayerOptions& options, unsigned threads,
                                                   std::span<const std::uint32_t> known) {
  std::vector<const Rings*> rings;
  rings.reserve(waiting.size());
  for (const WaitingFeature& feature : waiting) rings.push_back(&feature.rings);
  std::vector<std::vector<WaitingFeature*>> tasks;
  std::vector<bool> is_grouped(waiting.size(), false);
  const auto groups = options.merge > 0 ? group_for_blocks(rings)
                                        : group_features(rings, options.coverage, threads, known);
  for (const auto& group : groups) {
    auto& task = tasks.emplace_back();
    for (const std::uint32_t i : group) {
      task.push_back(&waiting[i]);
      is_grouped[i] = true;
    }
  }
  // Large tasks come first, so that no thread is left alone with one.
  std::stable_sort(tasks.begin(), tasks.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  for (std::size_t i = 0; i < waiting.size(); ++i) {
    if (!is_grouped[i]) tasks.push_back({&waiting[i]});
  }
  return tasks;
}

std::string with_others(std::size_t others) {
  const std::string gaps = "its gaps are not closed";
  if (others == 0) return gaps + ": ";
  return gaps + ", nor those of " + std::to_string(others) +
         (others == 1 ? " other feature: " : " other features: ");
}

}  // namespace

std::vector<std::uint64_t> classes_of(std::span<WaitingFeature* const> features) {
  std::vector<std::uint64_t> classes;
  if (std::ranges::all_of(features,
                          [](const auto* feature) { return feature->merge_class == 0; })) {
    return classes;
  }
  classes.reserve(features.size());
  for (const WaitingFeature* feature : features) classes.push_back(feature->merge_class);
  return classes;
}

unsigned thread_count(unsigned wanted) {
  return std::clamp(wanted != 0 ? wanted : std::thread::hardware_concurrency(), 1u, kMaxThreads);
}

/// One of the threads that project features to the grid, with its worker.
class FeaturePipeline::Lane {
 public:
  Lane(const FeatureSource& source, const LayerOptions& options, FeatureWorker& worker,
       std::shared_ptr<const TargetGrid> grid)
      : reader_(source, std::move(grid)),
        are_to_wait_(options.coverage != CoverageMode::off),
        are_merged_(options.merge > 0),
        worker_(worker) {}

  void take(const Job& job) {
    FeatureRings& feature = reader_.read(*job.geometry, job.layer_index);
    tally.polygons += feature.polygons;
    tally.rings += feature.source_rings;
    tally.source_vertices += feature.vertices;
    if (!feature.failure.empty()) return tally.skip(job.key, feature.failure);
    unite_parts_of(job.key, feature);
    if (are_to_wait_) tally.collapsed_rings += clean_rings(feature.rings);
    if (feature.rings.empty()) {
      ++tally.empty;
    } else if (are_to_wait_) {
      waiting_.push_back({job.key, feature.rings, {}, job.merge_class});
    } else {
      begin(static_cast<double>(job.bytes));
      worker_.build_apart(job.key, feature.rings, 1);
      end();
    }
  }

  void take(const Task& task, unsigned threads) {
    begin(work_of(task));
    // The polygons of a single feature are merged, too, and its courtyards are filled.
    if (task.size() == 1 && !are_merged_) {
      worker_.build_apart(task.front()->key, task.front()->rings_apart(), threads);
    } else {
      worker_.build_together(task, threads);
    }
    end();
    for (WaitingFeature* feature : task) feature->rings = feature->drawn = Rings();
  }

  /// In the unit of begin(). May be called from any thread.
  double work_done() const { return done_ + at_hand_ * worker_.share().get(); }

  std::vector<WaitingFeature> take_waiting() { return std::exchange(waiting_, {}); }

  FeatureTally tally;

 private:
  void unite_parts_of(const FeatureKey& key, FeatureRings& feature) {
    const PartUnion parts = unite_parts(feature.rings, feature.part_ends);
    if (!parts.failure.empty()) {
      tally.remark(key, "its parts cannot be united where they overlap: " + parts.failure);
    } else if (parts.did_overlap) {
      tally.remark(key, "united: its parts overlap");
    }
  }

  void begin(double work) {
    worker_.share().enter(0, 1);
    at_hand_ = work;
  }
  void end() { done_ = done_ + at_hand_.exchange(0); }

  SourceRingReader reader_;
  const bool are_to_wait_;
  const bool are_merged_;
  FeatureWorker& worker_;
  std::vector<WaitingFeature> waiting_;
  std::atomic<double> at_hand_ = 0;
  std::atomic<double> done_ = 0;
};

/// The lanes processing batches, each on its own thread.
class FeaturePipeline::Pool {
 public:
  explicit Pool(const std::vector<std::unique_ptr<Lane>>& lanes)
      : queue_(kWaitingBatchesPerLane * lanes.size()) {
    try {
      for (const auto& lane : lanes) {
        running_.push_back(std::async(std::launch::async, [this, &lane] { work(*lane); }));
      }
    } catch (...) {
      queue_.abandon();  // otherwise threads already started would wait for work
      throw;
    }
  }
  ~Pool() { queue_.abandon(); }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  /// False if a lane has failed: there is no point in reading on.
  bool add(Batch batch) { return queue_.push(std::move(batch)); }

  /// Nothing more is added: the lanes end when everything is done.
  std::vector<std::future<void>>& close() {
    queue_.close();
    return running_;
  }

 private:
  void work(Lane& lane) {
    try {
      while (const std::optional<Batch> batch = queue_.pop()) {
        for (const Job& job : *batch) lane.take(job);
      }
    } catch (...) {
      queue_.abandon();
      throw;
    }
  }

  BoundedQueue<Batch> queue_;
  std::vector<std::future<void>> running_;  // its destructor waits for them
};

FeaturePipeline::FeaturePipeline(FeatureSource& source, const LayerOptions& options,
                                 const std::vector<FeatureWorker*>& workers,
                                 std::function<void(double)> progress, const EarlierLayer* earlier,
                                 const std::shared_ptr<const TargetGrid>& grid)
    : source_(source),
      options_(options),
      classes_(source, options.merge_by),
      progress_(std::move(progress)),
      earlier_(earlier) {
  for (FeatureWorker* worker : workers) {
    lanes_.push_back(std::make_unique<Lane>(source, options, *worker, grid));
  }
}

FeaturePipeline::~FeaturePipeline() = default;

bool FeaturePipeline::run(const Take& take, const RoundLimit& limit) {
  bool is_more = false;
  {
    Pool pool(lanes_);
    is_more = read(take, limit, pool);
    read_until_ = std::chrono::steady_clock::now();
    is_all_read_ = !is_more;
    wait_for(pool.close());
  }
  if (options_.coverage != CoverageMode::off) build_waiting();
  return is_more;
}

bool FeaturePipeline::read(const Take& take, const RoundLimit& limit, Pool& pool) {
  std::size_t bytes = 0;
  const std::size_t first = features_;
  const auto hand_over = [&] {
    bytes += std::exchange(batch_bytes_, 0);
    return pool.add(std::exchange(batch_, {}));
  };
  SourceFeature next;
  bool is_more = true;
  while (features_ - first < limit.features && bytes + batch_bytes_ < limit.bytes &&
         (is_more = source_.next(next))) {
    accept(next, take);
    if (batch_bytes_ < kBatchBytes && batch_.size() < kBatchFeatures) continue;
    if (!hand_over()) return is_more;
    show_progress();
  }
  hand_over();
  return is_more;
}

void FeaturePipeline::accept(SourceFeature& next, const Take& take) {
  const std::size_t order = features_++;
  if (next.layer == nullptr) {
    ++tally_.other_geometry;
    return;
  }
  const std::int64_t id = next.feature->GetFID();
  if (next.follows_lost_lines) {
    tally_.skip({order, 0, id}, "is read, but what precedes it is not: " + next.failure);
    next.failure.clear();
  }
  std::unique_ptr<OGRGeometry> geometry(next.feature->StealGeometry(next.layer->geometry_field));
  if (geometry == nullptr && !next.failure.empty()) {
    tally_.skip({order, 0, id}, next.failure);
  } else if (geometry == nullptr) {
    ++tally_.other_geometry;
    tally_.remark({order, 0, id}, "has no geometry");
  } else if (!has_polygons(*geometry)) {
    ++tally_.other_geometry;
  } else {
    if (!next.failure.empty()) tally_.remark({order, 0, id}, "read, but: " + next.failure);
    const std::size_t bytes = geometry->WkbSize();
    batch_bytes_ += bytes;
    work_read_ += static_cast<double>(bytes);
    const std::uint64_t merge_class = classes_.class_of(next);
    batch_.push_back(
        {{order, take(next), id}, next.layer_index, std::move(geometry), bytes, merge_class});
  }
}

/// In the order of the source.
std::vector<WaitingFeature> FeaturePipeline::take_waiting() {
  std::vector<WaitingFeature> waiting;
  for (const auto& lane : lanes_) {
    for (WaitingFeature& feature : lane->take_waiting()) waiting.push_back(std::move(feature));
  }
  std::sort(waiting.begin(), waiting.end(),
            [](const auto& a, const auto& b) { return a.key.row < b.key.row; });
  return waiting;
}

void FeaturePipeline::close_gaps_between(std::vector<WaitingFeature>& waiting) {
  if (waiting.empty()) return;
  std::vector<Rings*> rings;
  rings.reserve(waiting.size());
  for (WaitingFeature& feature : waiting) rings.push_back(&feature.rings);
  GapClosing done = close_gaps(rings, options_.close_gaps);
  tally_.coverage.snapped += done.moved + done.led;
  for (std::size_t i = 0; i < waiting.size(); ++i) waiting[i].drawn = std::move(done.drawn[i]);
  if (!done.failure.empty()) {
    tally_.remark(waiting.front().key, "no gaps are closed: " + done.failure);
  }
  const auto remark = [&](const std::vector<std::uint32_t>& features, const std::string& why) {
    if (features.empty()) return;
    tally_.remark(waiting[features.front()].key, with_others(features.size() - 1) + why);
  };
  remark(done.narrow, "narrower than the distance");
  remark(done.kept, "would change or overlap by too much");
}

/// See group_features().
std::vector<std::uint32_t> FeaturePipeline::known_groups(
    const std::vector<WaitingFeature>& waiting) const {
  if (earlier_ == nullptr) return {};
  std::vector<Digest> digests(waiting.size());
  for_each_in_parallel(waiting.size(), lanes_.size(),
                       [&](std::size_t i) { digests[i] = digest_of(waiting[i].rings); });
  return earlier_->known_groups(digests, options_.close_gaps == 0);
}

/// Builds all waiting features, each with those with which it shares borders. The result does not
/// depend on the number of lanes.
void FeaturePipeline::build_waiting() {
  std::vector<WaitingFeature> waiting = take_waiting();
  if (options_.close_gaps > 0) {
    close_gaps_between(waiting);
    are_gaps_closed_ = true;
    show_progress();
  }
  const auto threads = static_cast<unsigned>(lanes_.size());
  std::vector<Task> tasks = tasks_of(waiting, options_, threads, known_groups(waiting));
  work_read_ = 0;
  for (const Task& task : tasks) work_read_ += work_of(task);
  is_grouped_ = true;
  show_progress();
  // A task that would keep one thread busy after all others have finished is processed by all of
  // them.
  const double much = work_read_ / (2 * threads);
  const auto is_large = [&](const Task& task) { return threads > 1 && work_of(task) > much; };
  const auto threads_for = [&](const Task& task) { return is_large(task) ? threads : 1; };
  if (options_.merge > 0) {
    // Merging into blocks is mostly work of one thread, however many there are.
    build(tasks, lanes_.size(), threads_for);
    return;
  }
  const auto is_large_group = [&](const Task& task) { return task.size() > 1 && is_large(task); };
  const auto others = std::stable_partition(tasks.begin(), tasks.end(), is_large_group);
  build({tasks.begin(), others}, 1, threads_for);
  std::stable_partition(others, tasks.end(), is_large);  // large ones come first
  build({others, tasks.end()}, lanes_.size(), threads_for);
}

/// Runs each task on one of the first lanes, which may use so many threads for it.
void FeaturePipeline::build(std::span<const Task> tasks, std::size_t lanes,
                            const std::function<unsigned(const Task&)>& threads_for) {
  std::atomic<std::size_t> next = 0;
  std::vector<std::future<void>> running;
  try {
    for (std::size_t i = 0; i < std::min(lanes, tasks.size()); ++i) {
      running.push_back(
          std::async(std::launch::async, [&next, tasks, &threads_for, &lane = lanes_[i]] {
            for (std::size_t t = next++; t < tasks.size(); t = next++) {
              lane->take(tasks[t], threads_for(tasks[t]));
            }
          }));
    }
    wait_for(running);
  } catch (...) {
    next = tasks.size();
    throw;
  }
}

/// Rethrows the exception of a lane that failed.
void FeaturePipeline::wait_for(std::vector<std::future<void>>& running) {
  for (std::future<void>& lane : running) {
    while (lane.wait_for(kProgressInterval) == std::future_status::timeout) show_progress();
    lane.get();
  }
}

/// The estimate may decrease; the reported progress does not.
void FeaturePipeline::show_progress() {
  if (!progress_) return;
  const double now = share();
  if (now >= 0) shown_ = std::max(shown_, now);
  progress_(now < 0 ? now : shown_);
}

/// The fraction of the expected time, from the costs of the stages per vertex.
double FeaturePipeline::share() const {
  const double read = is_all_read_ ? 1 : source_.progress();
  if (read < 0) return -1;
  const bool is_coverage = options_.coverage != CoverageMode::off;
  double built = 0;
  for (const auto& lane : lanes_) built += lane->work_done();
  // While reading continues, the features to come are expected to cost as much on average.
  const double work = work_read_ / std::max(read, kLeastShare);
  const double build_share = work > 0 ? std::min(1.0, built / work) : 0;
  double done = kReadCost * read + kBuildCost * build_share;
  double all = kReadCost + kBuildCost;
  if (is_coverage) {
    all += kGroupCost;
    if (is_grouped_) done += kGroupCost;
  }
  if (options_.close_gaps > 0) {
    all += kCloseGapsCost;
    if (are_gaps_closed_) done += kCloseGapsCost;
  }
  return done / all;
}

std::vector<const FeatureTally*> FeaturePipeline::tallies() const {
  std::vector<const FeatureTally*> tallies = {&tally_};
  for (const auto& lane : lanes_) tallies.push_back(&lane->tally);
  return tallies;
}

}  // namespace trapeze
