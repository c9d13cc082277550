// A layer that is one of several parts of a larger one, or the overview of them all; and what is
// known of it before anybody looks at it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/grid/tolerance.h"
#include "core/layer/layer.h"

namespace trapeze {

/// Which part it is.
struct PartNumber {
  std::uint32_t number = 0;    // 1 to count; 0: the overview
  std::uint32_t count = 0;     // of the parts
  std::uint64_t division = 0;  // equal for the parts into which one state of a source was divided
  // Of an overview:
  std::uint64_t revision_of_parts = 0;  // of those that it was made of
  Level first_level = 0;  // it shows what there is at this level, and at those that are coarser

  bool is_overview() const { return number == 0; }

  friend bool operator==(const PartNumber&, const PartNumber&) = default;
};

/// How much of a layer there is at each level.
struct LevelCounts {
  using Counts = std::array<std::uint64_t, std::size_t{kLastLevel} + 1>;

  Counts trapezoids = {};            // of polygons, alive at the tolerance
  Counts horizontal_edges = {};      // likewise
  Counts motes = {};                 // alive at the resolution
  Counts grains = {};                // born at the level
  std::uint64_t overlaps = 0;        // pairs of features that lie over each other, each twice
  std::uint64_t overlaps_along = 0;  // of these, those whose boundaries run along each other
};

LevelCounts count_by_level(const Layer& layer);

}  // namespace trapeze
