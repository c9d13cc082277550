// A layer of a database that reports which of its features have changed: only these, and the
// features built together with them, are read and built again.
//
// Thread-safety: one thread at a time.
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
  /// For a layer with a live_query that has not been read yet: changes from here on are reported.
  /// Throws as ChangeFeed does.
  explicit LiveLayer(const LayerConfig& config);

  /// Takes the layer as it was read afterwards. Returns it in the form to be served, in which only
  /// changed features take memory a second time. Throws std::runtime_error if two features have the
  /// same id.
  ServedLayer begin(ServedLayer read);

  /// The state after all changes since the last call; nothing if there are none. Throws
  /// std::exception if that cannot be determined; the next call tries again.
  std::optional<ServedLayer> next();

  /// The last state that begin() or next() returned.
  const ServedLayer& now() const { return served_; }

  /// Whether so much has changed that the layer should be read in full again.
  bool is_worn() const { return is_worn_; }

 private:
  std::optional<ServedLayer> patch(std::span<const std::int64_t> ids);
  /// What to apply for these changes; nothing if it is too much.
  struct Reading {
    std::vector<std::int64_t> ids;
    LoadedLayer features;
  };
  std::optional<Reading> read_changes(std::span<const std::int64_t> changed) const;
  std::optional<ServedLayer> join_patches();
  /// Without `changes`, the two states have to be compared.
  void take_step(std::optional<LayerChanges> changes, const Reading& reading);
  LoadedLayer read(std::span<const std::int64_t> ids) const;

  LayerConfig config_;
  ChangeFeed feed_;
  std::optional<LayerPatcher> patcher_;
  ServedLayer served_;
  std::set<std::int64_t> changed_;  // since it was read in full
  std::uint64_t changes_taken_ = 0;
  bool is_worn_ = false;
};

}  // namespace trapeze
