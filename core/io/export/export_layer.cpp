#include "core/io/export/export_layer.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include "core/adapt/adaptable_graph.h"
#include "core/borders/coverage_groups.h"
#include "core/borders/gap_closing.h"
#include "core/borders/polygons.h"
#include "core/io/export/polygon_file.h"
#include "core/io/export/polygon_geometry.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/open_source.h"
#include "core/io/source/source_name.h"
#include "core/io/source/source_ring_reader.h"
#include "core/sweep/clean_rings.h"
#include "core/sweep/graph_builder.h"

namespace trapeze {
namespace {

// As much as is read before it is adapted on all cores and written: enough that waiting for the
// last of each round costs little, little enough to hold.
constexpr std::size_t kRoundBytes = std::size_t{1} << 25;
constexpr std::size_t kRoundFeatures = 16384;
constexpr unsigned kMaxThreads = 256;

/// A polygon feature of the source and what becomes of it.
struct Job {
  OGRFeatureUniquePtr feature;  // without its geometry
  std::size_t layer_index = 0;
  std::unique_ptr<OGRGeometry> geometry;
  Rings rings;  // of one that waits for its neighbours; clean

  enum class Outcome { written, too_small, empty, skipped };
  Outcome outcome = Outcome::empty;
  std::string reason;  // for skipping it
  PolygonGeometry result;
  std::size_t polygons = 0;
  std::size_t rings_written = 0;
  std::size_t vertices = 0;
  std::size_t all_vertices = 0;
  std::size_t held = 0;
  bool crosses = false;
};

/// Does jobs; one a thread.
class Exporter {
 public:
  Exporter(const FeatureSource& source, const ExportOptions& options)
      : reader_(source), options_(options) {}

  void run(Job& job) {
    FeatureRings& feature = reader_.read(*job.geometry, job.layer_index);
    job.geometry.reset();
    if (!feature.failure.empty()) return skip(job, feature.failure);
    if (options_.generalization.coverage != CoverageMode::off) {
      clean_rings(feature.rings);
      job.rings = feature.rings;
    } else {
      run_apart(job, feature.rings);
    }
  }

  /// Those that have waited for each other.
  void run_together(std::span<Job* const> jobs) {
    if (jobs.size() == 1) return run_apart(*jobs.front(), jobs.front()->rings);
    std::vector<const Rings*> rings;
    for (const Job* job : jobs) rings.push_back(&job->rings);
    const Assembly assembly =
        assemble(rings, options_.generalization.coverage, options_.generalization.close_gaps,
                 coverage_builder_, graph_);
    if (!assembly.together.empty()) adapt_together(jobs, assembly);
    for (const std::uint32_t i : assembly.apart) run_apart(*jobs[i], jobs[i]->rings);
  }

 private:
  static void skip(Job& job, const std::string& reason) {
    job.outcome = Job::Outcome::skipped;
    job.reason = reason;
  }

  void run_apart(Job& job, Rings& rings) {
    const BuildOutcome built = builder_.build(rings, graph_);
    if (!built.failure.empty()) return skip(job, built.failure);
    if (!built.built) return;
    job.all_vertices = graph_.corners().size();
    AdaptableGraph adaptable(std::exchange(graph_, {}), options_.generalization);
    adaptable.adapt_to(options_.epsilon);
    const Polygons polygons = polygons_of(adaptable.graph());
    finish(job, polygons);
    if (job.polygons == 0) return;
    job.result = geometry_of(polygons, options_.crs);
    job.held = count_held(adaptable);
  }

  /// What the features of one graph have in common is counted with the first one that is written.
  void adapt_together(std::span<Job* const> jobs, const Assembly& assembly) {
    const std::vector<Rings> outlines = rings_of_faces(graph_);
    AdaptableGraph adaptable(std::exchange(graph_, {}), options_.generalization);
    adaptable.adapt_to(options_.epsilon);
    const std::vector<Polygons> polygons = polygons_of_faces(adaptable.graph());
    std::size_t held = count_held(adaptable);
    std::vector<PolygonGeometry> geometries = geometries_of_neighbours(polygons, options_.crs);
    for (const std::uint32_t i : assembly.together) {
      Job& job = *jobs[i];
      job.all_vertices = outlines[i].points.size();
      finish(job, polygons[i]);
      if (job.polygons == 0) continue;
      job.result = std::move(geometries[i]);
      job.held = std::exchange(held, 0);
    }
  }

  void finish(Job& job, const Polygons& polygons) const {
    if (!polygons.failure.empty()) return skip(job, polygons.failure);
    job.outcome = Job::Outcome::too_small;
    if (polygons.empty()) return;
    job.outcome = Job::Outcome::written;
    job.crosses = polygons.is_noded;
    job.polygons = polygons.size();
    job.rings_written = polygons.rings.size();
    job.vertices = polygons.rings.points.size();
  }

  std::size_t count_held(const AdaptableGraph& adaptable) const {
    std::size_t held = 0;
    for (std::size_t i = 0; i < adaptable.graph().corners().size(); ++i) {
      const CornerId c(i);
      const bool is_left = adaptable.graph().corner(c).is_alive();
      held += is_left && adaptable.stack().weight(c) < options_.epsilon ? 1 : 0;
    }
    return held;
  }

  SourceRingReader reader_;
  const ExportOptions& options_;
  GraphBuilder builder_;
  CoverageBuilder coverage_builder_;
  TrapezoidalGraph graph_;
};

/// Does rounds of jobs on several threads; each job's result depends on the job alone.
class ExporterPool {
 public:
  ExporterPool(const FeatureSource& source, const ExportOptions& options) {
    const unsigned wanted =
        options.threads != 0 ? options.threads : std::thread::hardware_concurrency();
    for (unsigned i = 0; i < std::clamp(wanted, 1u, kMaxThreads); ++i) {
      exporters_.emplace_back(source, options);
    }
  }

  /// Rethrows what stopped a job.
  void run(std::vector<Job>& jobs) {
    work_on(jobs.size(), [&](Exporter& exporter, std::size_t i) { exporter.run(jobs[i]); });
  }

  /// The same of groups of jobs that have been run, and waited for each other.
  void run_together(const std::vector<std::vector<Job*>>& groups) {
    work_on(groups.size(),
            [&](Exporter& exporter, std::size_t i) { exporter.run_together(groups[i]); });
  }

 private:
  template <typename Work>
  void work_on(std::size_t count, const Work& work) {
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::exception_ptr failure;
    const auto work_all = [&](Exporter& exporter) {
      try {
        for (std::size_t i = next++; i < count; i = next++) work(exporter, i);
      } catch (...) {
        next = count;
        const std::lock_guard lock(mutex);
        failure = std::current_exception();
      }
    };
    std::vector<std::thread> threads;
    for (std::size_t i = 1; i < exporters_.size() && i < count; ++i) {
      threads.emplace_back(work_all, std::ref(exporters_[i]));
    }
    work_all(exporters_.front());
    for (std::thread& thread : threads) thread.join();
    if (failure != nullptr) std::rethrow_exception(failure);
  }

  std::vector<Exporter> exporters_;
};

/// Reads, has the jobs done, and writes, one round after another.
class Export {
 public:
  Export(FeatureSource& source, PolygonFile& file, const ExportOptions& options)
      : source_(source), file_(file), options_(options), pool_(source, options) {}

  ExportReport run() {
    report_.driver = file_.driver();
    report_.features = report_.other_geometry = source_.passed_over();
    SourceFeature next;
    while (source_.next(next)) {
      take(next);
      // Any feature may be a neighbour of any other one.
      const bool is_full = bytes_ >= kRoundBytes || jobs_.size() >= kRoundFeatures;
      if (is_full && !is_coverage()) finish_round();
    }
    finish_round();
    file_.finish();
    if (options_.progress) options_.progress(1);
    return std::move(report_);
  }

 private:
  void take(SourceFeature& next) {
    ++report_.features;
    if (next.layer == nullptr) {
      ++report_.other_geometry;
      return;
    }
    std::unique_ptr<OGRGeometry> geometry(next.feature->StealGeometry(next.layer->geometry_field));
    if (geometry != nullptr && has_polygons(*geometry)) {
      bytes_ += geometry->WkbSize();
      Job& job = jobs_.emplace_back();
      job.feature = std::move(next.feature);
      job.layer_index = next.layer_index;
      job.geometry = std::move(geometry);
    } else if (geometry == nullptr && !next.failure.empty()) {
      ++report_.skipped;
      report_.notes.push_back({next.feature->GetFID(), next.failure});
    } else {
      ++report_.other_geometry;
    }
  }

  void finish_round() {
    pool_.run(jobs_);
    if (is_coverage()) pool_.run_together(neighbours());
    for (Job& job : jobs_) count(job);
    jobs_.clear();
    bytes_ = 0;
    if (options_.progress) options_.progress(source_.progress());
  }

  bool is_coverage() const { return options_.generalization.coverage != CoverageMode::off; }

  /// The jobs that have waited, those that share borders together.
  std::vector<std::vector<Job*>> neighbours() {
    std::vector<Job*> waiting;
    std::vector<Rings*> to_close;
    std::vector<const Rings*> rings;
    for (Job& job : jobs_) {
      if (job.rings.empty()) continue;
      waiting.push_back(&job);
      to_close.push_back(&job.rings);
      rings.push_back(&job.rings);
    }
    if (options_.generalization.close_gaps > 0) {
      close_gaps(to_close, options_.generalization.close_gaps);
    }
    std::vector<std::vector<Job*>> groups;
    for (const auto& group : group_features(rings, options_.generalization.coverage)) {
      auto& jobs = groups.emplace_back();
      for (const std::uint32_t i : group) jobs.push_back(std::exchange(waiting[i], nullptr));
    }
    for (Job* job : waiting) {
      if (job != nullptr) groups.push_back({job});
    }
    return groups;
  }

  void count(Job& job) {
    report_.all_vertices += job.all_vertices;
    switch (job.outcome) {
      case Job::Outcome::too_small:
        ++report_.too_small;
        return;
      case Job::Outcome::empty:
        ++report_.empty;
        return;
      case Job::Outcome::skipped:
        ++report_.skipped;
        report_.notes.push_back({job.feature->GetFID(), job.reason});
        return;
      case Job::Outcome::written:
        write(job);
        return;
    }
  }

  void write(Job& job) {
    ++report_.written;
    report_.polygons += job.polygons;
    report_.rings += job.rings_written;
    report_.vertices += job.vertices;
    report_.held += job.held;
    report_.crossed += job.crosses ? 1 : 0;
    report_.subdivided += job.result.subdivided;
    report_.unchecked += job.result.unchecked;
    if (job.result.is_invalid) {
      ++report_.invalid;
      report_.notes.push_back({job.feature->GetFID(), "is not valid in degrees"});
    }
    file_.write(*job.feature, job.layer_index, std::move(job.result.geometry));
  }

  FeatureSource& source_;
  PolygonFile& file_;
  const ExportOptions& options_;
  ExporterPool pool_;
  std::vector<Job> jobs_;
  std::size_t bytes_ = 0;
  ExportReport report_;
};

}  // namespace

std::optional<ExportCrs> export_crs_from_name(std::string_view name) {
  if (name == "EPSG:4326") return ExportCrs::degrees;
  if (name == "EPSG:3857") return ExportCrs::web_mercator;
  return std::nullopt;
}

ExportReport export_layer(const std::string& source, const std::string& output,
                          const ExportOptions& options) {
  PolygonFile::check_path(output, source, options.overwrite);
  FeatureSource features(source);
  PolygonFile file(output, features, options.crs);
  try {
    return Export(features, file, options).run();
  } catch (const SourceError& error) {
    throw std::runtime_error(name_of_source(source) + ": " + error.what());
  }
}

}  // namespace trapeze
