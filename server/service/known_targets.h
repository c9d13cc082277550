// Remembers what frequently requested tile targets refer to, so that they need not be parsed again.
//
// Thread-safety: all methods may be called from any thread.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/lru_map.h"
#include "server/data/dataset.h"
#include "server/tiles/tile_request.h"

namespace trapeze {

/// A tile for one state of the data.
struct KnownTarget {
  std::string fingerprint;  // also its key in the cache
  TileFormat format = TileFormat::png;
  std::vector<std::size_t> layers;  // that it shows, by index in the dataset
};

class KnownTargets {
 public:
  /// `budget` is in bytes.
  explicit KnownTargets(std::size_t budget) : shard_budget_(budget / kShards) {
    for (Shard& shard : shards_) shard.known = Map(shard_budget_);
  }

  /// Whether the meaning of a target depends only on the target and the data. Targets with named
  /// styles do not qualify: such styles come and go.
  static bool may_be_known(std::string_view target) {
    return target.size() <= kMostBytes && !contains(target, "/s/") && !contains(target, "style") &&
           !has_encoded_letters(target);
  }

  /// The tile for that dataset; null if it is not known.
  std::shared_ptr<const KnownTarget> find(const std::shared_ptr<const Dataset>& dataset,
                                          const std::string& target) {
    Shard& shard = shard_of(target);
    const std::lock_guard lock(shard.mutex);
    if (!is_of(shard, dataset)) return nullptr;
    const auto* known = shard.known.find(target);
    return known == nullptr ? nullptr : *known;
  }

  /// Precondition: may_be_known(target).
  void insert(const std::shared_ptr<const Dataset>& dataset, const std::string& target,
              KnownTarget known) {
    const std::size_t bytes = kOverhead + 2 * target.size() + known.fingerprint.size() +
                              known.layers.size() * sizeof(std::size_t);
    auto kept = std::make_shared<const KnownTarget>(std::move(known));
    Shard& shard = shard_of(target);
    const std::lock_guard lock(shard.mutex);
    if (!is_of(shard, dataset)) {
      shard.known = Map(shard_budget_);
      shard.dataset = dataset;
    }
    if (shard.known.find(target) == nullptr) shard.known.insert(target, std::move(kept), bytes);
  }

 private:
  static constexpr std::size_t kShards = 16;  // so that threads rarely wait for each other
  static constexpr std::size_t kMostBytes = 2048;
  static constexpr std::size_t kOverhead = 300;  // bytes per entry

  using Map = LruMap<std::string, std::shared_ptr<const KnownTarget>>;
  struct Shard {
    std::mutex mutex;
    std::weak_ptr<const Dataset> dataset;
    Map known{0};
  };

  static bool contains(std::string_view text, std::string_view part) {
    return text.find(part) != std::string_view::npos;
  }
  // For example "%73tyle"; letters need no encoding.
  static bool has_encoded_letters(std::string_view text) {
    for (std::size_t i = text.find('%'); i < text.size(); i = text.find('%', i + 1)) {
      if (i + 1 < text.size() && text[i + 1] >= '4' && text[i + 1] <= '7') return true;
    }
    return false;
  }

  /// Compares owners, not addresses: a new dataset may be at the address of an old one.
  static bool is_of(const Shard& shard, const std::shared_ptr<const Dataset>& dataset) {
    return !shard.dataset.owner_before(dataset) && !dataset.owner_before(shard.dataset);
  }
  Shard& shard_of(const std::string& target) {
    return shards_[std::hash<std::string>()(target) % kShards];
  }

  std::size_t shard_budget_;
  std::array<Shard, kShards> shards_;
};

}  // namespace trapeze
