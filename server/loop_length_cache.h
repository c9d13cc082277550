// Keeps how far along its outline every edge of a feature lies, for dashed outlines.
//
// Thread-safety: one thread at a time; every worker has its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <tuple>
#include <vector>

#include "core/layer.h"
#include "core/loop_lengths.h"

namespace trapeze {

class LoopLengthCache {
 public:
  /// `budget` in bytes; the feature asked for last is always kept.
  explicit LoopLengthCache(std::size_t budget) : budget_(budget) {}

  /// The edges of feature `row` as it is at the level, in ascending order. Valid until the next
  /// call.
  const std::vector<LoopEdge>& find(const Layer& layer, Level level, std::uint32_t row);

 private:
  using Key = std::tuple<std::uint64_t, Level, std::uint32_t>;  // of mesh, level and row
  struct Entry {
    Key key;
    std::vector<LoopEdge> edges;
  };

  std::size_t budget_;
  std::size_t bytes_ = 0;
  std::list<Entry> entries_;  // the last used first
  std::map<Key, std::list<Entry>::iterator> by_key_;
};

}  // namespace trapeze
