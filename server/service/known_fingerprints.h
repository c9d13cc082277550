// Remembers the fingerprints of recently requested tiles, so that they need not be computed again.
//
// Thread-safety: all methods may be called from any thread.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>

#include "server/base/lru_map.h"

namespace trapeze {

class KnownFingerprints {
 public:
  /// `budget` is in bytes.
  explicit KnownFingerprints(std::size_t budget) {
    for (Shard& shard : shards_) shard.known = Map(budget / kShards);
  }

  /// Looks up the key of a plan, which includes the revisions of its layers; empty if it is not
  /// known.
  std::string find(const std::string& plan_key) {
    Shard& shard = shard_of(plan_key);
    const std::lock_guard lock(shard.mutex);
    const std::string* known = shard.known.find(plan_key);
    return known == nullptr ? std::string() : *known;
  }

  void insert(const std::string& plan_key, const std::string& fingerprint) {
    Shard& shard = shard_of(plan_key);
    const std::lock_guard lock(shard.mutex);
    if (shard.known.find(plan_key) != nullptr) return;
    shard.known.insert(plan_key, fingerprint, kOverhead + 2 * plan_key.size() + fingerprint.size());
  }

 private:
  static constexpr std::size_t kShards = 16;     // so that threads rarely wait for each other
  static constexpr std::size_t kOverhead = 200;  // bytes per entry

  using Map = LruMap<std::string, std::string>;
  struct Shard {
    std::mutex mutex;
    Map known{0};
  };

  Shard& shard_of(const std::string& plan_key) {
    return shards_[std::hash<std::string>()(plan_key) % kShards];
  }

  std::array<Shard, kShards> shards_;
};

}  // namespace trapeze
