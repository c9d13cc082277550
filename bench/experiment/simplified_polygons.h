// Simplified polygons.
#pragma once

#include <cstdint>
#include <vector>

#include "core/grid/rings.h"

namespace trapeze::experiment {

/// Consecutive polygons, without those that were removed.
struct SimplifiedPolygons {
  Rings rings;
  std::vector<std::uint32_t> ends;    // polygon i is rings ends[i - 1] .. ends[i] - 1
  std::vector<std::uint32_t> source;  // by polygon: its index in the PolygonSet

  void clear() {
    rings.clear();
    ends.clear();
    source.clear();
  }
  std::size_t size() const { return ends.size(); }
  std::uint32_t first_ring(std::size_t polygon) const {
    return polygon == 0 ? 0 : ends[polygon - 1];
  }
};

}  // namespace trapeze::experiment
