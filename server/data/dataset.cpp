#include "server/data/dataset.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <functional>
#include <future>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "core/io/file/prepared_file.h"
#include "core/layer/layer_arrays.h"
#include "core/layer/layer_contents.h"
#include "core/layer/untested_layer.h"
#include "server/base/content_hash.h"
#include "server/data/fast_topology.h"
#include "server/data/layer_warnings.h"
#include "server/data/load_progress.h"
#include "server/data/note_summary.h"
#include "server/data/source_files.h"

namespace trapeze {
namespace {

constexpr std::size_t kMaxLoggedNotes = 10;

void add_value(ContentHash& hash, const Value& value) {
  hash.add(value.index());
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    hash.add(static_cast<std::uint64_t>(*integer));
  } else if (const auto* real = std::get_if<double>(&value)) {
    hash.add(std::bit_cast<std::uint64_t>(*real));
  } else if (const auto* text = std::get_if<std::string_view>(&value)) {
    hash.add(*text);
  }
}

void log_notes(const std::string& what, const LoadReport& report) {
  const std::vector<std::string> lines = summarize_notes(report.notes);
  for (std::size_t i = 0; i < lines.size() && i < kMaxLoggedNotes; ++i) {
    spdlog::warn(fmt::format("{}: {}", what, lines[i]));
  }
  if (lines.size() < report.notes.size()) {
    spdlog::warn(fmt::format("{}: `trapeze check` lists all notes", what));
  }
}

void log_missing_title(const ServedLayer& served) {
  const std::string problem =
      find_title_problem(served.layer->features(), served.config.title_attribute);
  if (!problem.empty()) spdlog::warn(fmt::format("layer \"{}\" {}", served.config.name, problem));
}

/// Logs problems of a layer in parts that do not prevent it from being served.
void log_parts(const std::string& what, const PreparedParts& parts) {
  spdlog::info(fmt::format("{}: {} parts, each loaded when needed", what, parts.parts().size()));
  const std::string problem = find_overview_problem(parts);
  if (!problem.empty()) spdlog::warn(fmt::format("{}: {}", what, problem));
}

void log_report(const ServedLayer& served) {
  const LoadReport& report = served.report;
  // The source, and the grid if the layer is built for several.
  const std::string what = served.config.grid.empty()
                               ? report.path
                               : fmt::format("{} in {}", report.path, served.config.grid);
  spdlog::info(fmt::format(
      "{}: {} of {} features, {} polygons, {} rings, {} vertices, {} trapezoids, {:.1f} MB, "
      "{:.2f} s ({})",
      what, report.loaded, report.features, report.polygons, report.rings, report.vertices,
      served.trapezoids(), static_cast<double>(served.memory_of_tested()) / 1e6,
      report.total_seconds, report.origin()));
  if (served.parts != nullptr) log_parts(what, *served.parts);
  if (report.taken_over > 0) {
    spdlog::info(fmt::format("{}: {} features are unchanged and reused", what, report.taken_over));
  }
  if (report.other_geometry > 0) {
    spdlog::info(fmt::format("{}: {} features are not polygons and are not drawn", what,
                             report.other_geometry));
  }
  if (report.empty > 0) {
    spdlog::info(fmt::format("{}: {} polygons are smaller than the grid, or outside of the world",
                             what, report.empty));
  }
  const CoverageCounts& coverage = report.coverage;
  if (coverage.groups > 0) {
    spdlog::info(fmt::format(
        "{}: {} features share borders, in {} groups: {} shared edges, {} junctions; {} features "
        "overlap others by too much and are simplified separately",
        what, coverage.features, coverage.groups, coverage.shared_edges, coverage.junctions,
        coverage.apart));
  }
  if (report.repaired > 0 || report.skipped > 0 || report.coverage.overlaps > 0) {
    spdlog::warn(fmt::format("{}: {} features repaired, {} skipped, {} pairs overlap", what,
                             report.repaired, report.skipped, report.coverage.overlaps));
  }
  for (const std::string& warning : report.warnings)
    spdlog::warn(fmt::format("{}: {}", what, warning));
  log_notes(what, report);
  if (report.loaded == 0) spdlog::warn(fmt::format("{}: contains no polygon to draw", what));
}

/// The combined progress of layers that load at the same time: the mean of their shares.
class SharedProgress {
 public:
  SharedProgress(const std::vector<LayerConfig>& layers, LayersToRead* told)
      : told_(told),
        shares_(layers.size(), 0),
        progress_(std::in_place, layers.size() == 1 ? layers.front().file_to_open()
                                                    : fmt::format("{} layers", layers.size())),
        stalls_(sources_of(layers)) {
    if (told_ == nullptr) return;
    std::vector<LayerProgress> nothing_read;
    nothing_read.reserve(layers.size());
    for (const LayerConfig& layer : layers) {
      const std::string of_grid = layer.grid.empty() ? "" : " in " + layer.grid;
      nothing_read.push_back({layer.name + of_grid, layer.title + of_grid, 0});
    }
    told_->begin(std::move(nothing_read));
  }

  void show(std::size_t layer, double share) {
    const std::lock_guard lock(mutex_);
    shares_[layer] = share;
    if (told_ != nullptr) told_->show(layer, share);
    stalls_.got_on(layer);
    const bool is_known = std::ranges::none_of(shares_, [](double s) { return s < 0; });
    const double sum = std::accumulate(shares_.begin(), shares_.end(), 0.0);
    progress_->show(is_known ? sum / static_cast<double>(shares_.size()) : -1);
  }

  /// Waits until the layer has been read; it is not watched after that.
  void wait(std::size_t layer, const std::future<ServedLayer>& reading) {
    constexpr auto kLook = std::chrono::seconds(1);
    while (reading.wait_for(kLook) != std::future_status::ready) {
      const std::lock_guard lock(mutex_);
      stalls_.look();
    }
    const std::lock_guard lock(mutex_);
    stalls_.finish(layer);
  }

  /// The layer is ready to be served, however long others take.
  void finish(std::size_t layer) {
    const std::lock_guard lock(mutex_);
    stalls_.finish(layer);
    if (told_ != nullptr) told_->finish(layer);
  }

  void finish() { progress_.reset(); }

 private:
  static std::vector<std::string> sources_of(const std::vector<LayerConfig>& layers) {
    std::vector<std::string> sources;
    sources.reserve(layers.size());
    for (const LayerConfig& layer : layers) sources.push_back(layer.file_to_open());
    return sources;
  }

  LayersToRead* const told_;
  std::mutex mutex_;
  std::vector<double> shares_;
  std::optional<LoadProgress> progress_;
  StallWatch stalls_;
};

/// Whether the same files give the same layer: the other settings only affect how it is shown.
bool are_read_the_same(const LayerConfig& a, const LayerConfig& b) {
  const OpenOptions how_a = how_to_open(a);
  const OpenOptions how_b = how_to_open(b);
  return a.file_to_open() == b.file_to_open() && how_a.weights == how_b.weights &&
         how_a.coverage == how_b.coverage && how_a.close_gaps == how_b.close_gaps &&
         how_a.merge == how_b.merge && how_a.merge_by == how_b.merge_by &&
         how_a.selection == how_b.selection && how_a.prepared_from == how_b.prepared_from &&
         how_a.grid == how_b.grid && a.has_fast_topology() == b.has_fast_topology();
}

/// The layer as it was read before, if reading it now would give the same.
std::optional<ServedLayer> unchanged_layer(const LayerConfig& layer, const Dataset* previous) {
  if (previous == nullptr) return std::nullopt;
  const std::string state = state_of_sources(layer);
  if (state.empty()) return std::nullopt;
  for (const ServedLayer& served : previous->layers_on_all_grids()) {
    if (served.source_state == state && are_read_the_same(served.config, layer) &&
        served.is_whole() && served.whole == nullptr) {
      ServedLayer kept = served;
      kept.config = layer;
      return kept;
    }
  }
  return std::nullopt;
}

/// The layer as it is being served; null if it is not.
const ServedLayer* find_served(const LayerConfig& layer, const Dataset* previous) {
  if (previous == nullptr) return nullptr;
  const auto position = previous->find(layer.name, layer.grid);
  return position ? &previous->layers_on_all_grids()[*position] : nullptr;
}

/// A message if a layer lost most of the features being served; empty if not.
std::string find_loss(const ServedLayer& now, const Dataset* previous) {
  const ServedLayer* before = find_served(now.config, previous);
  if (now.config.may_shrink || before == nullptr) return {};
  if (before->config.selection != now.config.selection) return {};
  if (2 * now.report.loaded >= before->report.loaded) return {};
  return fmt::format(
      "{}: {} features can be drawn, fewer than half of the {} that are served; if that is right, "
      "set may_shrink = true",
      now.report.path, now.report.loaded, before->report.loaded);
}

/// Throws, with all reasons, if layers that could be read must not be served.
void check_layers(const std::vector<ServedLayer>& layers, const Dataset* previous) {
  std::string problems;
  for (const ServedLayer& layer : layers) {
    for (const std::string& problem :
         {find_excess(layer.report, layer.config.max_skipped), find_loss(layer, previous)}) {
      if (problem.empty()) continue;
      problems += fmt::format("{}layer \"{}\": {}", problems.empty() ? "" : "; ", layer.config.name,
                              problem);
    }
  }
  if (!problems.empty()) throw std::runtime_error(problems);
}

/// Reuses everything that has not changed since `earlier`, unless that is null.
LoadedLayer open_with(const LayerConfig& layer, OpenOptions options, const ServedLayer* earlier) {
  if (earlier == nullptr || !earlier->is_whole()) return open_layer(layer.file_to_open(), options);
  options.earlier = earlier->whole != nullptr ? earlier->whole : earlier->layer;
  LoadedLayer loaded = open_layer(layer.file_to_open(), options);
  if (earlier->is_whole()) return loaded;
  // Its file was overwritten meanwhile.
  options.earlier = nullptr;
  return open_layer(layer.file_to_open(), options);
}

/// `progress` is called by the calling thread.
ServedLayer read_layer(const LayerConfig& layer, const ServedLayer* earlier,
                       const std::function<void(double)>& progress) {
  if (const std::string problem = find_topology_problem(layer); !problem.empty()) {
    throw std::runtime_error(problem);
  }
  ServedLayer served;
  served.config = layer;
  served.source_state = state_of_sources(layer);  // before reading: later changes are noticed
  OpenOptions options = how_to_open(layer);
  options.progress = progress;
  if (earlier != nullptr) options.earlier_parts = earlier->parts;
  LoadedLayer loaded = open_with(layer, options, earlier);
  served.revision = loaded.revision ? *loaded.revision : revision_of(*loaded.layer);
  served.layer = std::move(loaded.layer);
  if (layer.has_fast_topology()) served.untested = build_without_topology_test(*served.layer);
  served.report = std::move(loaded.report);
  served.file = std::move(loaded.file);
  served.parts = std::move(loaded.parts);
  served.label_anchors = loaded.label_anchors;
  // Its fields may be defined in another file.
  if (served.report.driver == "GML" && served.file == nullptr) served.source_state.clear();
  return served;
}

}  // namespace

OpenOptions how_to_open(const LayerConfig& layer) {
  OpenOptions options;
  options.weights = layer.weights;
  options.coverage = layer.coverage;
  options.close_gaps = layer.close_gaps;
  options.merge = layer.merge;
  options.merge_by = layer.merge_by;
  options.selection = layer.selection;
  options.prepared_from = layer.prepared.empty() ? "" : layer.file;
  options.grid = layer.grid;
  return options;
}

double ServedLayer::merge() const {
  return layer->contents().options.merge;
}

std::size_t ServedLayer::trapezoids() const {
  if (parts == nullptr) return layer->mesh().trapezoids.size();
  const LayerSize size = parts->size();
  return size.trapezoids + size.motes;
}

std::size_t ServedLayer::memory_of_tested() const {
  if (parts != nullptr) return parts->file_size();
  return layer->memory() + layer->features().memory();
}

std::string prepared_on_grid(const std::string& prepared, const std::string& grid) {
  std::string of_grid = grid;
  std::ranges::replace(of_grid, ':', '-');
  std::filesystem::path path(prepared);
  const std::string ending = path.extension().string();
  return path.replace_extension(of_grid + ending).string();
}

std::vector<LayerConfig> with_grids(const std::vector<LayerConfig>& layers) {
  std::vector<LayerConfig> all = layers;
  for (const LayerConfig& layer : layers) {
    for (const std::string& name : layer.crs) {
      if (name == kBuiltCrs) continue;
      LayerConfig& more = all.emplace_back(layer);
      more.grid = name;
      if (!layer.prepared.empty()) {
        more.prepared = prepared_on_grid(layer.prepared, name);
      } else if (is_prepared_file(layer.file)) {
        more.file = prepared_on_grid(layer.file, name);
      }
    }
  }
  return all;
}

std::string ServedLayer::label() const {
  return config.grid.empty() ? config.name : fmt::format("{} in {}", config.name, config.grid);
}

std::size_t ServedLayer::memory() const {
  return memory_of_tested() + (untested == nullptr ? 0 : untested->memory());
}

Problem damaged_layer(const ServedLayer& layer) {
  return {503, fmt::format("The file of the layer \"{}\" has been truncated or modified. It has to "
                           "be prepared again.",
                           layer.config.name)};
}

std::uint64_t revision_of(const Layer& layer) {
  ContentHash hash;
  const LayerArrays arrays = arrays_of(layer);
  hash.add(arrays.vertices);
  hash.add(arrays.edges);
  hash.add(arrays.trapezoids);
  hash.add(arrays.lifespans);
  hash.add(arrays.feature_of);
  hash.add(arrays.grains);
  hash.add(arrays.outline_points);
  hash.add(arrays.ring_ends);
  hash.add(arrays.outline_ends);
  const FeatureTable& features = layer.features();
  for (const Field& field : features.fields()) hash.add(field.name);
  for (std::uint32_t row = 0; row < features.size(); ++row) {
    hash.add(static_cast<std::uint64_t>(features.id(row)));
    for (int field = 0; field < static_cast<int>(features.fields().size()); ++field) {
      add_value(hash, features.value(row, field));
    }
  }
  return hash.value();
}

std::shared_ptr<const Dataset> Dataset::load(const std::vector<LayerConfig>& configured,
                                             const Dataset* previous, LayersToRead* told,
                                             std::shared_ptr<const NamedTables> tables) {
  const std::vector<LayerConfig> layers = with_grids(configured);
  // All at the same time: while one layer is in a single-threaded step, others use the other cores.
  SharedProgress progress(layers, told);
  std::vector<ServedLayer> served(layers.size());
  std::vector<std::pair<std::size_t, std::future<ServedLayer>>> reading;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const auto show = [&progress, i](double share) { progress.show(i, share); };
    if (auto kept = unchanged_layer(layers[i], previous)) {
      served[i] = *std::move(kept);
      spdlog::info(fmt::format("{}: unchanged, not read again", served[i].report.path));
      show(1);
      progress.finish(i);
    } else {
      const ServedLayer* earlier = find_served(layers[i], previous);
      reading.emplace_back(i,
                           std::async(std::launch::async, [&layers, &progress, i, show, earlier] {
                             ServedLayer layer = read_layer(layers[i], earlier, show);
                             progress.finish(i);
                             return layer;
                           }));
    }
  }
  for (auto& [i, layer] : reading) {
    progress.wait(i, layer);
    served[i] = layer.get();
  }
  progress.finish();
  for (const auto& [i, layer] : reading) log_report(served[i]);
  for (const ServedLayer& layer : served) log_missing_title(layer);
  check_layers(served, previous);
  if (tables == nullptr && previous != nullptr) tables = previous->tables_;
  return std::make_shared<const Dataset>(std::move(served), std::move(tables));
}

Dataset::Dataset(std::vector<ServedLayer> layers, std::shared_ptr<const NamedTables> tables)
    : layers_(std::move(layers)),
      on_mercator_(static_cast<std::size_t>(std::ranges::count_if(
          layers_, [](const ServedLayer& layer) { return layer.config.grid.empty(); }))),
      tables_(std::move(tables)) {
  std::shared_ptr<DerivedValues> derived;
  for (const ServedLayer& layer : layers_) {
    if (tables_ == nullptr) tables_ = layer.tables;
    if (derived == nullptr) derived = layer.derived;
  }
  if (derived == nullptr) derived = std::make_shared<DerivedValues>();
  ContentHash hash;
  for (ServedLayer& layer : layers_) {
    layer.tables = tables_;
    layer.derived = derived;
    hash.add(layer.config.name);
    if (!layer.config.grid.empty()) hash.add(layer.config.grid);
    hash.add(layer.revision);
    hash.add(layer.config.style.canonical_text());
    for (const int zoom : {layer.config.min_zoom, layer.config.max_zoom}) {
      hash.add(static_cast<std::uint64_t>(zoom));
    }
  }
  for (const auto& [name, named] : this->tables()) {
    hash.add(name);
    hash.add(named.table->id());
    for (const auto& [language, table] : named.languages) {
      hash.add(language);
      hash.add(table->id());
    }
  }
  generation_ = hash.hex();
}

const NamedTables& Dataset::tables() const {
  static const NamedTables none;
  return tables_ == nullptr ? none : *tables_;
}

std::optional<std::size_t> Dataset::find(std::string_view name, std::string_view grid) const {
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    if (layers_[i].config.name == name && layers_[i].config.grid == grid) return i;
  }
  return std::nullopt;
}

std::vector<std::string> Dataset::grids() const {
  std::vector<std::string> grids;
  for (const ServedLayer& layer : std::span(layers_).subspan(on_mercator_)) {
    if (std::ranges::find(grids, layer.config.grid) == grids.end()) {
      grids.push_back(layer.config.grid);
    }
  }
  return grids;
}

}  // namespace trapeze
