// The identity and size of a layer that is one of several parts of a larger one, or the overview of
// all parts; available without loading the layer.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/grid/tolerance.h"
#include "core/layer/layer.h"

namespace trapeze {

/// The identity of a part.
struct PartNumber {
  std::uint32_t number = 0;    // 1 to count; 0: the overview
  std::uint32_t count = 0;     // of the parts
  std::uint64_t division = 0;  // equal for the parts into which one state of a source was divided
  // For an overview only:
  std::uint64_t revision_of_parts = 0;  // of the parts that it was made from
  Level first_level = 0;                // it shows this level and all coarser ones

  bool is_overview() const { return number == 0; }

  friend bool operator==(const PartNumber&, const PartNumber&) = default;
};

/// The size of a layer at each level.
struct LevelCounts {
  using Counts = std::array<std::uint64_t, std::size_t{kLastLevel} + 1>;

  Counts trapezoids = {};            // of polygons, alive at the tolerance
  Counts horizontal_edges = {};      // the same
  Counts motes = {};                 // alive at the resolution
  Counts grains = {};                // born at the level
  std::uint64_t overlaps = 0;        // pairs of features that overlap, each counted twice
  std::uint64_t overlaps_along = 0;  // of these, pairs whose boundaries run along each other
};

LevelCounts count_by_level(const Layer& layer);

}  // namespace trapeze
