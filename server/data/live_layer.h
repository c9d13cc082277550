// A layer of a database that tells which of its features have changed: only those, and what is
// built together with them, are read and built anew.
//
// Belongs to one thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/io/source/change_feed.h"
#include "core/layer/layer_patcher.h"
#include "server/data/dataset.h"

namespace trapeze {

class LiveLayer {
 public:
  /// Of a layer with a live_query that has not been read yet: what changes from here on is told.
  /// Throws as ChangeFeed does.
  explicit LiveLayer(const LayerConfig& config);

  /// Takes the layer as it has been read since. Returns it as it is to be served, so that no more
  /// than what changes takes memory a second time. Throws std::runtime_error if two of its features
  /// have one id.
  ServedLayer begin(ServedLayer read);

  /// Its state after all that has changed since it was asked last; nothing if nothing has. Throws
  /// std::exception if that cannot be known: next time it is tried again.
  std::optional<ServedLayer> next();

  /// Whether it should be read whole again, as so much has changed by now.
  bool is_worn() const { return is_worn_; }

 private:
  std::optional<ServedLayer> patch(std::span<const std::int64_t> ids);
  /// What there is to apply for changes of these; nothing if it is too much.
  struct Reading {
    std::vector<std::int64_t> ids;
    LoadedLayer features;
  };
  std::optional<Reading> read_changes(std::span<const std::int64_t> changed) const;
  std::optional<ServedLayer> join_patches();
  void take_step(LayerChanges changes, std::uint64_t what);
  LoadedLayer read(std::span<const std::int64_t> ids) const;

  LayerConfig config_;
  ChangeFeed feed_;
  std::optional<LayerPatcher> patcher_;
  ServedLayer served_;
  std::set<std::int64_t> changed_;  // since it was read whole
  std::uint64_t changes_taken_ = 0;
  bool is_worn_ = false;
};

}  // namespace trapeze
