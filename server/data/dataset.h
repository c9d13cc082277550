// The layers being served: loaded together, immutable, replaced only as a whole.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/file/mapped_file.h"
#include "core/io/load/load_layer.h"
#include "core/layer/layer.h"
#include "core/layer/untested_layer.h"
#include "server/base/problem.h"
#include "server/config/config.h"

namespace trapeze {

struct ServedLayer {
  LayerConfig config;
  std::unique_ptr<const Layer> layer;
  LoadReport report;
  std::uint64_t revision = 0;                          // revision_of(*layer)
  std::shared_ptr<const MappedFile> file = {};         // of a prepared layer
  std::unique_ptr<const UntestedLayer> untested = {};  // beside `layer`; made by Dataset

  /// False if its prepared file was written into while it was mapped.
  bool is_whole() const { return file == nullptr || file->is_whole(); }
};

/// The problem, 503, with a layer whose prepared file was written into.
Problem damaged_layer(const ServedLayer& layer);

/// A hash of geometry, attributes and which feature has which polygon: equal on every machine that
/// loaded the same layer.
std::uint64_t revision_of(const Layer& layer);

/// Thread-safety: immutable, any number of threads may read.
class Dataset {
 public:
  /// Loads all layers at once, or maps those that are prepared, on all cores, with progress and a
  /// summary in the log. Throws std::runtime_error naming the file if one cannot be read, or was
  /// prepared otherwise than configured.
  static std::shared_ptr<const Dataset> load(const std::vector<LayerConfig>& layers);

  explicit Dataset(std::vector<ServedLayer> layers);

  const std::vector<ServedLayer>& layers() const { return layers_; }
  /// Position of the layer of that name.
  std::optional<std::size_t> find(std::string_view name) const;
  /// Hex digits that change when any layer's name or contents change, and only then: equal on every
  /// machine that serves the same data.
  const std::string& generation() const { return generation_; }

 private:
  std::vector<ServedLayer> layers_;
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
