// Keeps how far along its outline every edge of a feature lies, for dashed outlines.
//
// Thread-safety: one thread at a time; every worker has its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/layer/layer.h"
#include "core/mesh/loop_lengths.h"
#include "server/base/lru_map.h"

namespace trapeze {

class LoopLengthCache {
 public:
  /// `budget` in bytes; the feature asked for last is always kept.
  explicit LoopLengthCache(std::size_t budget) : outlines_(budget) {}

  /// The edges of feature `row` as it is at the level, in ascending order. Valid until the next
  /// call.
  const std::vector<LoopEdge>& find(const Layer& layer, Level level, std::uint32_t row);

 private:
  struct Key {
    std::uint64_t mesh;
    std::uint32_t row;
    Level level;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& key) const {
      return ((key.mesh * 0x9e3779b97f4a7c15 + key.row) * 0x9e3779b97f4a7c15 + key.level) *
                 0x9e3779b97f4a7c15 >>
             20;
    }
  };

  LruMap<Key, std::vector<LoopEdge>, KeyHash> outlines_;
};

}  // namespace trapeze
