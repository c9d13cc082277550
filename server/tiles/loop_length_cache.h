// Keeps how far along its outline every edge of a feature lies, for dashed outlines.
//
// Thread-safety: one thread at a time; every worker has its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <unordered_map>
#include <vector>

#include "core/layer/layer.h"
#include "core/mesh/loop_lengths.h"

namespace trapeze {

class LoopLengthCache {
 public:
  /// `budget` in bytes; the feature asked for last is always kept.
  explicit LoopLengthCache(std::size_t budget) : budget_(budget) {}

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
  struct Entry {
    Key key;
    std::vector<LoopEdge> edges;
  };

  std::size_t budget_;
  std::size_t bytes_ = 0;
  std::list<Entry> entries_;  // the last used first
  std::unordered_map<Key, std::list<Entry>::iterator, KeyHash> by_key_;
};

}  // namespace trapeze
