// The layers being served: loaded together, immutable, replaced only as a whole.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/file/mapped_file.h"
#include "core/io/load/load_layer.h"
#include "core/io/prepared/open_layer.h"
#include "core/io/prepared/prepared_parts.h"
#include "core/labels/label_anchors.h"
#include "core/layer/layer.h"
#include "core/layer/layer_changes.h"
#include "server/base/problem.h"
#include "server/config/config.h"
#include "server/data/load_progress.h"
#include "server/values/derived_values.h"
#include "server/values/value_book.h"

namespace trapeze {

struct ServedLayer {
  LayerConfig config;
  /// For a layer in several parts, this holds what the parts share, fields and bounds, and no
  /// features.
  std::shared_ptr<const Layer> layer;  // shared with the previous dataset if unchanged
  LoadReport report;
  std::uint64_t revision = 0;  // revision_of(*layer); of a live layer, also of its replacements
  std::shared_ptr<const MappedFile> file = {};  // of a prepared layer
  std::string source_state = {};                // state_of_sources() before it was read
  /// The parts of a layer in several parts; null for all other layers.
  std::shared_ptr<const PreparedParts> parts = {};
  /// See LoadedLayer; for a layer whose features are replaced, those of `whole`.
  std::span<const LabelAnchor> label_anchors = {};
  /// Built without the topological consistency test; null unless the configuration requests it.
  std::shared_ptr<const Layer> untested = {};

  /// For a layer whose features are replaced while it is served (see LiveLayer), the layer as it
  /// was read in full; null for others.
  std::shared_ptr<const Layer> whole = {};
  /// Where the layer may look different from its state under an earlier revision.
  struct Step {
    std::uint64_t since = 0;
    LayerChanges changes;
  };
  std::shared_ptr<const Step> last_step = {};  // null: it was read in full

  /// The configured tables that styles may join; null: none.
  std::shared_ptr<const NamedTables> tables = {};
  /// Joins and class breaks computed for styles, shared by the layers of a dataset; null: nothing
  /// is kept.
  std::shared_ptr<DerivedValues> derived = {};

  /// The layer to draw, unless it is in several parts; null if it was not built without the test.
  const Layer* layer_for(Topology topology) const {
    return topology == Topology::strict ? layer.get() : untested.get();
  }
  /// For people: its name, with its grid unless that is the one of Web Mercator.
  std::string label() const;
  /// The distance it was built with, configured or not: see LayerOptions.
  double merge() const;
  /// The total of all parts.
  LayerSize size() const { return parts == nullptr ? layer->size() : parts->size(); }
  /// Includes versions of trapezoids, horizontal edges and dust.
  std::size_t trapezoids() const;
  std::size_t memory_of_tested() const;
  /// In bytes: geometry, index and attributes, including the layer without the test. For a layer in
  /// parts, the size of the files: resident memory may be much less.
  std::size_t memory() const;
  /// False if a prepared file of the layer was overwritten while it was mapped, or is no longer the
  /// same.
  bool is_whole() const {
    if (parts != nullptr) return parts->is_whole();
    return file == nullptr || file->is_whole();
  }
  /// The same, but may be slightly out of date.
  bool was_whole_lately() const {
    return parts != nullptr ? parts->was_whole_lately() : is_whole();
  }
};

/// The problem, 503, for a layer whose prepared file was overwritten.
Problem damaged_layer(const ServedLayer& layer);

/// A hash of geometry, attributes and the assignment of features to polygons: equal on every
/// machine that loaded the same layer.
std::uint64_t revision_of(const Layer& layer);

/// The layers, followed by the same layers on the other grids of their configuration. On those,
/// prepared files are looked for next to the main prepared file, see prepared_on_grid().
std::vector<LayerConfig> with_grids(const std::vector<LayerConfig>& layers);
/// The name of a prepared file for another grid: "land.EPSG-2056.trapeze" for "land.trapeze".
std::string prepared_on_grid(const std::string& prepared, const std::string& grid);

/// The settings of a layer that determine how its file is read.
OpenOptions how_to_open(const LayerConfig& layer);

/// Thread-safety: immutable, any number of threads may read.
class Dataset {
 public:
  /// Loads all layers at the same time on all cores, or memory-maps the prepared ones, with
  /// progress and a summary in the log. If `previous` is not null, its layers are reused if neither
  /// their files nor the way of reading them changed; for layers whose files changed, everything
  /// built from unchanged rings is reused (see LoadOptions::earlier).
  /// Throws std::runtime_error that names the file if a layer cannot be read, was prepared with
  /// other settings than configured, or has more skipped features than its configuration allows.
  /// Also throws if a layer has less than half the features that `previous` draws of the layer with
  /// the same name and the same selection of the source, unless its configuration allows that.
  /// If `told` is not null, it receives the progress of each layer. `tables` are those of the
  /// configuration; null: those of `previous`.
  static std::shared_ptr<const Dataset> load(const std::vector<LayerConfig>& configured,
                                             const Dataset* previous = nullptr,
                                             LayersToRead* told = nullptr,
                                             std::shared_ptr<const NamedTables> tables = nullptr);

  /// Layers on other grids must come last. If `tables` is null, the tables of the layers are used.
  explicit Dataset(std::vector<ServedLayer> layers,
                   std::shared_ptr<const NamedTables> tables = nullptr);

  /// On the grid of Web Mercator, which all layers are on.
  std::span<const ServedLayer> layers() const { return std::span(layers_).first(on_mercator_); }
  /// The same, followed by those on the grids of other reference systems.
  const std::vector<ServedLayer>& layers_on_all_grids() const { return layers_; }
  /// The index of the layer with that name in both lists; for a layer on another grid, in the
  /// second one.
  std::optional<std::size_t> find(std::string_view name, std::string_view grid = {}) const;
  /// The names of all other grids that layers are on, without duplicates, in the order of the
  /// layers.
  std::vector<std::string> grids() const;
  /// The tables of the configuration.
  const NamedTables& tables() const;
  /// Hex digits that change if and only if the name or contents of a layer or table, or a layer's
  /// own style or zooms change: equal on every machine that serves the same data.
  const std::string& generation() const { return generation_; }

 private:
  std::vector<ServedLayer> layers_;
  std::size_t on_mercator_ = 0;
  std::shared_ptr<const NamedTables> tables_;  // null: none
  std::string generation_;
};

/// The current dataset, null while the first one is loading. Thread-safe.
class CurrentDataset {
 public:
  std::shared_ptr<const Dataset> get() const {
    const std::lock_guard lock(mutex_);
    return dataset_;
  }
  void set(std::shared_ptr<const Dataset> dataset) {
    const std::lock_guard lock(mutex_);
    dataset_.swap(dataset);  // the old one is destroyed after unlocking
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const Dataset> dataset_;
};

}  // namespace trapeze
