#include "core/io/export/export_layer.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/adapt/adaptable_graph.h"
#include "core/borders/coverage_groups.h"
#include "core/borders/grown_polygons.h"
#include "core/borders/polygons.h"
#include "core/borders/rounded_polygons.h"
#include "core/grid/for_each_in_parallel.h"
#include "core/io/export/polygon_file.h"
#include "core/io/export/polygon_geometry.h"
#include "core/io/export/vector_file.h"
#include "core/io/load/feature_pipeline.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/open_source.h"
#include "core/io/source/source_name.h"
#include "core/layer/full_detail.h"
#include "core/sweep/graph_builder.h"

namespace trapeze {
namespace {

// The amount read and adapted before it is written: large enough that waiting for the last item of
// each round costs little, and small enough to hold in memory.
constexpr FeaturePipeline::RoundLimit kRound{std::size_t{1} << 25, 16384};

/// Whether a style is applied to the polygons once all of them are known.
bool is_reshaped(const ExportOptions& options) {
  return options.smooth.radius > 0 || options.grow.width > 0;
}

/// The result for a polygon feature.
struct Adapted {
  FeatureKey key;
  enum class Outcome { written, too_small, empty, skipped };
  Outcome outcome = Outcome::empty;
  std::string reason;   // why it is skipped
  DrawnPolygons drawn;  // until they are reshaped
  PolygonGeometry result;
  std::size_t polygons = 0;
  std::size_t rings_written = 0;
  std::size_t vertices = 0;
  std::size_t all_vertices = 0;
  std::size_t held = 0;
  bool crosses = false;

  /// Sets these polygons as the result; false if there are none to write.
  bool take(const Polygons& shape) {
    reason = shape.failure;
    outcome = !reason.empty() ? Outcome::skipped
              : shape.empty() ? Outcome::too_small
                              : Outcome::written;
    polygons = shape.size();
    rings_written = shape.rings.size();
    return outcome == Outcome::written;
  }
};

/// Adapts features to the tolerance.
class Exporter : public FeatureWorker {
 public:
  explicit Exporter(const ExportOptions& options) : options_(options) {}

  void build_apart(const FeatureKey& feature, Rings& rings, unsigned threads) override {
    Adapted& adapted = begin(feature);
    const BuildOutcome built = builder_.build(rings, graph_, threads);
    if (!built.failure.empty()) return skip(adapted, built.failure);
    if (!built.built) return;
    adapted.all_vertices = graph_.corners().size();
    if (is_reshaped(options_)) full_detail_.add(graph_, FaceFeatures({feature.row}), feature.row);
    AdaptableGraph adaptable(std::exchange(graph_, {}), options_.generalization);
    adaptable.adapt_to(options_.epsilon);
    Polygons polygons = polygons_of(adaptable.graph());
    if (!finish(adapted, polygons)) return;
    adapted.held = count_held(adaptable);
    if (is_reshaped(options_)) {
      adapted.drawn = {feature.row, false, std::move(polygons)};
    } else {
      adapted.result = geometry_of(polygons, options_.crs);
    }
  }

  void build_together(std::span<WaitingFeature* const> features, unsigned threads) override {
    std::vector<const Rings*> rings;
    for (const WaitingFeature* feature : features) rings.push_back(&feature->rings);
    const LayerOptions& how = options_.generalization;
    const Assembly assembly = assemble(rings, how.coverage, how.close_gaps, coverage_builder_,
                                       graph_, nullptr, threads, how.merging(classes_of(features)));
    if (!assembly.together.empty()) adapt_together(features, assembly);
    for (const std::uint32_t i : assembly.apart) {
      build_apart(features[i]->key, features[i]->rings_apart(), threads);
    }
  }

  /// The results since the last call, in any order.
  std::vector<Adapted> take_adapted() { return std::exchange(adapted_, {}); }
  /// The features since the last call, if they are reshaped.
  FullDetail take_full_detail() { return std::exchange(full_detail_, {}); }

 private:
  Adapted& begin(const FeatureKey& feature) {
    Adapted& adapted = adapted_.emplace_back();
    adapted.key = feature;
    return adapted;
  }

  static void skip(Adapted& adapted, const std::string& reason) {
    adapted.outcome = Adapted::Outcome::skipped;
    adapted.reason = reason;
  }

  /// Values that belong to the whole graph are counted with the first feature that is written.
  void adapt_together(std::span<WaitingFeature* const> features, const Assembly& assembly) {
    const FaceFeatures& faces = assembly.outcome.faces;
    std::vector<std::uint32_t> rows;
    for (const WaitingFeature* feature : features) rows.push_back(feature->key.row);
    const std::uint32_t number = rows[assembly.together.front()];
    if (is_reshaped(options_)) full_detail_.add(graph_, faces.named(rows), number);
    const std::vector<Rings> outlines = rings_of_features(graph_, faces);
    const std::optional<MergePlan>& plan = assembly.outcome.plan;
    AdaptableGraph adaptable(std::exchange(graph_, {}), options_.generalization,
                             plan ? &*plan : nullptr);
    adaptable.adapt_to(options_.epsilon);
    std::vector<Polygons> polygons = polygons_of_features(adaptable.graph(), faces);
    std::size_t held = count_held(adaptable);
    std::vector<PolygonGeometry> geometries(polygons.size());
    if (!is_reshaped(options_)) geometries = geometries_of_neighbours(polygons, options_.crs);
    for (const std::uint32_t i : assembly.together) {
      Adapted& adapted = begin(features[i]->key);
      adapted.all_vertices = outlines[i].points.size();
      if (!finish(adapted, polygons[i])) continue;
      adapted.result = std::move(geometries[i]);
      adapted.held = std::exchange(held, 0);
      if (is_reshaped(options_)) adapted.drawn = {number, false, std::move(polygons[i])};
    }
  }

  static bool finish(Adapted& adapted, const Polygons& polygons) {
    if (!adapted.take(polygons)) return false;
    adapted.crosses = polygons.is_noded;
    adapted.vertices = polygons.rings.points.size();
    return true;
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

  const ExportOptions& options_;
  GraphBuilder builder_;
  CoverageBuilder coverage_builder_;
  TrapezoidalGraph graph_;
  FullDetail full_detail_;
  std::vector<Adapted> adapted_;
};

/// Has features adapted and writes them, one round after another.
class Export {
 public:
  Export(FeatureSource& source, PolygonFile& file, const ExportOptions& options)
      : source_(source),
        file_(file),
        options_(options),
        pipeline_(source, options.generalization, make_workers(), options.progress) {}

  ExportReport run() {
    const FeaturePipeline::Take take = [this](SourceFeature& next) { return keep(next); };
    // Any feature may be a neighbour of any other.
    const bool are_all_held =
        options_.generalization.coverage != CoverageMode::off || is_reshaped(options_);
    const auto round = are_all_held ? FeaturePipeline::RoundLimit{} : kRound;
    bool is_more = true;
    while (is_more) {
      is_more = pipeline_.run(take, round);
      write_round();
    }
    file_.finish();
    fill_report();
    if (options_.progress) options_.progress(1);
    return std::move(report_);
  }

 private:
  /// A polygon feature of the source.
  struct Kept {
    OGRFeatureUniquePtr feature;  // without its geometry
    std::size_t layer_index = 0;
  };

  std::vector<FeatureWorker*> make_workers() {
    for (unsigned i = 0; i < thread_count(options_.threads); ++i) exporters_.emplace_back(options_);
    std::vector<FeatureWorker*> workers;
    for (Exporter& exporter : exporters_) workers.push_back(&exporter);
    return workers;
  }

  std::uint32_t keep(SourceFeature& next) {
    kept_.push_back({std::move(next.feature), next.layer_index});
    return first_row_ + static_cast<std::uint32_t>(kept_.size() - 1);
  }

  /// Writes in the order of the source.
  void write_round() {
    std::vector<Adapted> round;
    for (Exporter& exporter : exporters_) {
      for (Adapted& adapted : exporter.take_adapted()) round.push_back(std::move(adapted));
    }
    std::ranges::sort(round, {}, [](const Adapted& adapted) { return adapted.key.row; });
    if (is_reshaped(options_)) reshape(round);
    for (Adapted& adapted : round) count(adapted);
    first_row_ += static_cast<std::uint32_t>(kept_.size());
    kept_.clear();
  }

  /// Rounds corners or grows narrow features in everything that is written, and makes geometries of
  /// the result.
  void reshape(std::vector<Adapted>& round) {
    const unsigned threads = thread_count(options_.threads);
    FullDetail all;
    for (Exporter& exporter : exporters_) all.add(exporter.take_full_detail());
    const std::vector<std::uint8_t> is_overlapping = all.overlapping(threads);
    std::vector<Adapted*> written;
    std::vector<DrawnPolygons*> polygons;
    for (Adapted& adapted : round) {
      if (adapted.outcome != Adapted::Outcome::written) continue;
      adapted.drawn.lies_over_others = is_overlapping[adapted.key.row] != 0;
      polygons.push_back(&adapted.drawn);
      written.push_back(&adapted);
    }
    if (options_.smooth.radius > 0) {
      report_.corners = round_corners(polygons, options_.smooth, threads);
    } else {
      const GrownPolygons grown = grow(polygons, options_.grow, threads);
      if (!grown.failure.empty()) {
        throw SourceError("the widened polygons cannot be united: " + grown.failure);
      }
      report_.grown = grown.grown;
    }
    std::map<std::uint32_t, std::vector<Adapted*>> by_graph;
    for (Adapted* adapted : written) by_graph[adapted->drawn.graph].push_back(adapted);
    std::vector<std::vector<Adapted*>> graphs;
    graphs.reserve(by_graph.size());
    for (auto& [graph, features] : by_graph) graphs.push_back(std::move(features));
    for_each_in_parallel(graphs.size(), threads,
                         [&](std::size_t i) { make_geometries(graphs[i]); });
  }

  /// For the features of one graph.
  void make_geometries(std::span<Adapted* const> features) const {
    std::vector<Polygons> polygons;
    for (Adapted* adapted : features) polygons.push_back(std::move(adapted->drawn.polygons));
    std::vector<PolygonGeometry> geometries;
    if (features.size() > 1) {
      geometries = geometries_of_neighbours(polygons, options_.crs);
    } else if (!polygons.front().empty()) {
      geometries.push_back(geometry_of(polygons.front(), options_.crs));
    }
    for (std::size_t i = 0; i < features.size(); ++i) {
      if (features[i]->take(polygons[i])) features[i]->result = std::move(geometries[i]);
    }
  }

  void count(Adapted& adapted) {
    report_.all_vertices += adapted.all_vertices;
    switch (adapted.outcome) {
      case Adapted::Outcome::too_small:
        ++report_.too_small;
        return;
      case Adapted::Outcome::empty:
        ++report_.empty;
        return;
      case Adapted::Outcome::skipped:
        ++report_.skipped;
        note(adapted.key, adapted.reason);
        return;
      case Adapted::Outcome::written:
        write(adapted);
        return;
    }
  }

  void write(Adapted& adapted) {
    ++report_.written;
    report_.polygons += adapted.polygons;
    report_.rings += adapted.rings_written;
    report_.vertices += adapted.vertices;
    report_.held += adapted.held;
    report_.crossed += adapted.crosses ? 1 : 0;
    report_.subdivided += adapted.result.subdivided;
    report_.unchecked += adapted.result.unchecked;
    if (adapted.result.is_invalid) {
      ++report_.invalid;
      note(adapted.key, "is not valid in degrees");
    }
    const Kept& kept = kept_[adapted.key.row - first_row_];
    file_.write(*kept.feature, kept.layer_index, std::move(adapted.result.geometry));
  }

  void note(const FeatureKey& feature, const std::string& words) {
    notes_.push_back({feature.order, {feature.id, words}});
  }

  void fill_report() {
    report_.driver = file_.driver();
    report_.warnings = source_.warnings();
    report_.features = source_.passed_over() + pipeline_.features();
    report_.other_geometry = source_.passed_over();
    for (const FeatureTally* tally : pipeline_.tallies()) {
      report_.other_geometry += tally->other_geometry;
      report_.empty += tally->empty;
      report_.skipped += tally->skipped;
      notes_.insert(notes_.end(), tally->skips.begin(), tally->skips.end());
    }
    sort_by_order(notes_);
    for (OrderedNote& note : notes_) report_.notes.push_back(std::move(note.note));
  }

  FeatureSource& source_;
  PolygonFile& file_;
  const ExportOptions& options_;
  std::deque<Exporter> exporters_;
  FeaturePipeline pipeline_;
  std::vector<Kept> kept_;       // of the current round
  std::uint32_t first_row_ = 0;  // of these
  std::vector<OrderedNote> notes_;
  ExportReport report_;
};

}  // namespace

ExportReport export_layer(const std::string& source, const std::string& output,
                          const ExportOptions& options) {
  VectorFile::check_path(output, source, options.overwrite);
  FeatureSource features(source);
  PolygonFile file(output, features, options.crs);
  try {
    return Export(features, file, options).run();
  } catch (const SourceError& error) {
    throw std::runtime_error(name_of_source(source) + ": " + error.what());
  }
}

}  // namespace trapeze
