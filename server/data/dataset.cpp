#include "server/data/dataset.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>
#include <future>
#include <numeric>

#include "core/io/prepared/open_layer.h"
#include "core/layer/layer_arrays.h"
#include "server/base/content_hash.h"
#include "server/data/load_progress.h"
#include "server/data/note_summary.h"

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

void log_notes(const LoadReport& report) {
  const std::vector<std::string> lines = summarize_notes(report.notes);
  for (std::size_t i = 0; i < lines.size() && i < kMaxLoggedNotes; ++i) {
    spdlog::warn("{}: {}", report.path, lines[i]);
  }
  if (lines.size() < report.notes.size()) {
    spdlog::warn("{}: `trapeze check` lists all notes", report.path);
  }
}

void log_report(const LoadReport& report, const Layer& layer) {
  spdlog::info(
      "{}: {} of {} features, {} polygons, {} rings, {} vertices, {} trapezoids, {:.1f} MB, "
      "{:.2f} s ({})",
      report.path, report.loaded, report.features, report.polygons, report.rings, report.vertices,
      layer.mesh().trapezoids.size(),
      static_cast<double>(layer.memory() + layer.features().memory()) / 1e6, report.total_seconds,
      report.origin());
  if (report.other_geometry > 0) {
    spdlog::info("{}: {} features are not polygons and are not drawn", report.path,
                 report.other_geometry);
  }
  if (report.empty > 0) {
    spdlog::info("{}: {} polygons are smaller than the grid, or outside of the world", report.path,
                 report.empty);
  }
  if (report.repaired > 0 || report.skipped > 0 || report.coverage.overlaps > 0) {
    spdlog::warn("{}: {} features repaired, {} skipped, {} pairs overlap", report.path,
                 report.repaired, report.skipped, report.coverage.overlaps);
  }
  log_notes(report);
  if (report.loaded == 0) spdlog::warn("{}: there is no polygon to draw", report.path);
}

/// One progress for several layers that load at once: the mean of their shares.
class SharedProgress {
 public:
  explicit SharedProgress(const std::vector<LayerConfig>& layers)
      : shares_(layers.size(), 0),
        progress_(std::in_place, layers.size() == 1 ? layers.front().file_to_open()
                                                    : fmt::format("{} layers", layers.size())) {}

  void show(std::size_t layer, double share) {
    const std::lock_guard lock(mutex_);
    shares_[layer] = share;
    const bool is_known = std::ranges::none_of(shares_, [](double s) { return s < 0; });
    const double sum = std::accumulate(shares_.begin(), shares_.end(), 0.0);
    progress_->show(is_known ? sum / static_cast<double>(shares_.size()) : -1);
  }
  void finish() { progress_.reset(); }

 private:
  std::mutex mutex_;
  std::vector<double> shares_;
  std::optional<LoadProgress> progress_;
};

}  // namespace

Problem damaged_layer(const ServedLayer& layer) {
  return {503,
          fmt::format("The file of the layer \"{}\" has been cut off or written into. It has to be "
                      "prepared again.",
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

std::shared_ptr<const Dataset> Dataset::load(const std::vector<LayerConfig>& layers) {
  // All at once: while one layer is at a step for one core, another one uses the others.
  SharedProgress progress(layers);
  std::vector<std::future<ServedLayer>> loading;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    loading.push_back(std::async(std::launch::async, [&progress, &layers, i] {
      const LayerConfig& layer = layers[i];
      OpenOptions options;
      options.weights = layer.weights;
      options.coverage = layer.coverage;
      options.close_gaps = layer.close_gaps;
      options.selection = layer.selection;
      options.prepared_from = layer.prepared.empty() ? "" : layer.file;
      options.progress = [&progress, i](double share) { progress.show(i, share); };
      LoadedLayer loaded = open_layer(layer.file_to_open(), options);
      const std::uint64_t revision =
          loaded.revision ? *loaded.revision : revision_of(*loaded.layer);
      return ServedLayer{layers[i], std::move(loaded.layer), std::move(loaded.report), revision,
                         std::move(loaded.file)};
    }));
  }
  std::vector<ServedLayer> served;
  served.reserve(loading.size());
  for (std::future<ServedLayer>& layer : loading) served.push_back(layer.get());
  progress.finish();
  for (const ServedLayer& layer : served) log_report(layer.report, *layer.layer);
  return std::make_shared<const Dataset>(std::move(served));
}

Dataset::Dataset(std::vector<ServedLayer> layers) : layers_(std::move(layers)) {
  ContentHash hash;
  for (ServedLayer& layer : layers_) {
    layer.untested = std::make_unique<UntestedLayer>(*layer.layer);
    hash.add(layer.config.name);
    hash.add(layer.revision);
  }
  generation_ = hash.hex();
}

std::optional<std::size_t> Dataset::find(std::string_view name) const {
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    if (layers_[i].config.name == name) return i;
  }
  return std::nullopt;
}

}  // namespace trapeze
