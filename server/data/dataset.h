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
  /// Of a layer in several parts, what they have in common, fields and bounds, and no feature.
  std::shared_ptr<const Layer> layer;  // shared with the dataset before, if it did not change
  LoadReport report;
  std::uint64_t revision = 0;  // revision_of(*layer); of a live layer, by what was replaced too
  std::shared_ptr<const MappedFile> file = {};  // of a prepared layer
  std::string source_state = {};                // state_of_sources() before it was read
  /// Of a layer in several parts: these. Null of all others.
  std::shared_ptr<const PreparedParts> parts = {};
  /// See LoadedLayer; of a layer in which features are replaced, those of `whole`.
  std::span<const LabelAnchor> label_anchors = {};
  /// Without the topological consistency test; null unless the configuration asks for it.
  std::shared_ptr<const Layer> untested = {};

  /// Of a layer in which features are replaced while it is served (see LiveLayer), as it was read
  /// whole; null of others.
  std::shared_ptr<const Layer> whole = {};
  /// Where it may look different from what it was under an earlier revision.
  struct Step {
    std::uint64_t since = 0;
    LayerChanges changes;
  };
  std::shared_ptr<const Step> last_step = {};  // null: it was read whole

  /// The tables of the configuration that styles may join; null: none.
  std::shared_ptr<const NamedTables> tables = {};
  /// What was found out about it for styles, shared by the layers of a dataset; null: nothing is
  /// kept.
  std::shared_ptr<DerivedValues> derived = {};

  /// The layer to draw, unless it is in several parts; null if it is not there without the test.
  const Layer* layer_for(Topology topology) const {
    return topology == Topology::strict ? layer.get() : untested.get();
  }
  /// For people: its name, and its grid if that is another than that of Web Mercator.
  std::string label() const;
  /// As it was built, whether or not it is configured: see LayerOptions.
  double merge() const;
  /// Of all of its parts.
  LayerSize size() const { return parts == nullptr ? layer->size() : parts->size(); }
  /// Versions of trapezoids, horizontal edges and dust among them.
  std::size_t trapezoids() const;
  std::size_t memory_of_tested() const;
  /// In bytes: geometry, index and attributes, and what there is of it without the test. Of a layer
  /// in parts, that of the files: what is resident may be much less.
  std::size_t memory() const;
  /// False if a prepared file of it was written into while it was mapped, or is not what it was.
  bool is_whole() const {
    if (parts != nullptr) return parts->is_whole();
    return file == nullptr || file->is_whole();
  }
  /// The same, perhaps of a moment ago.
  bool was_whole_lately() const {
    return parts != nullptr ? parts->was_whole_lately() : is_whole();
  }
};

/// The problem, 503, with a layer whose prepared file was written into.
Problem damaged_layer(const ServedLayer& layer);

/// A hash of geometry, attributes and which feature has which polygon: equal on every machine that
/// loaded the same layer.
std::uint64_t revision_of(const Layer& layer);

/// The layers, and after them all of the other grids that their configuration names. On those, a
/// prepared file is looked for beside the prepared one, see prepared_on_grid().
std::vector<LayerConfig> with_grids(const std::vector<LayerConfig>& layers);
/// The name of a prepared file for another grid: "land.EPSG-2056.trapeze" of "land.trapeze".
std::string prepared_on_grid(const std::string& prepared, const std::string& grid);

/// What of a layer's configuration decides how its file is read.
OpenOptions how_to_open(const LayerConfig& layer);

/// Thread-safety: immutable, any number of threads may read.
class Dataset {
 public:
  /// Loads all layers at once, or maps those that are prepared, on all cores, with progress and a
  /// summary in the log. A layer that `previous` has, if that is not null, is taken from there if
  /// neither its files nor how it is read have changed; of one whose files have, what is built of
  /// the same rings is (see LoadOptions::earlier). Throws std::runtime_error naming the file
  /// if one cannot be read, was prepared otherwise than configured, has more skipped features than
  /// its configuration allows, or, unless that allows it, fewer than half of the features that
  /// `previous` draws of the layer of that name, of whose source the same was selected.
  /// `told`, if it is not null, is told how far each layer is. `tables` are those of the
  /// configuration; null: those of `previous`.
  static std::shared_ptr<const Dataset> load(const std::vector<LayerConfig>& configured,
                                             const Dataset* previous = nullptr,
                                             LayersToRead* told = nullptr,
                                             std::shared_ptr<const NamedTables> tables = nullptr);

  /// Layers on other grids come last. `tables` that are null are those that the layers have.
  explicit Dataset(std::vector<ServedLayer> layers,
                   std::shared_ptr<const NamedTables> tables = nullptr);

  /// On the grid of Web Mercator, which is where every layer is.
  std::span<const ServedLayer> layers() const { return std::span(layers_).first(on_mercator_); }
  /// The same, and then those on the grids of other reference systems.
  const std::vector<ServedLayer>& layers_on_all_grids() const { return layers_; }
  /// Position, in both, of the layer of that name; on another grid, in the second.
  std::optional<std::size_t> find(std::string_view name, std::string_view grid = {}) const;
  /// The names of the other grids that there are layers on, each once, in the order of the layers.
  std::vector<std::string> grids() const;
  /// Those of the configuration.
  const NamedTables& tables() const;
  /// Hex digits that change when any layer's or table's name or contents, or a layer's own style or
  /// zooms change, and only then: equal on every machine that serves the same data.
  const std::string& generation() const { return generation_; }

 private:
  std::vector<ServedLayer> layers_;
  std::size_t on_mercator_ = 0;
  std::shared_ptr<const NamedTables> tables_;  // null: none
  std::string generation_;
};

/// The dataset of now, null while the first is loading. Thread-safe.
class CurrentDataset {
 public:
  std::shared_ptr<const Dataset> get() const {
    const std::lock_guard lock(mutex_);
    return dataset_;
  }
  void set(std::shared_ptr<const Dataset> dataset) {
    const std::lock_guard lock(mutex_);
    dataset_.swap(dataset);  // the old one dies with the parameter, after the lock
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const Dataset> dataset_;
};

}  // namespace trapeze
