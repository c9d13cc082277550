// The segments of several features, each with the feature whose boundary it is a part of.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/rings.h"
#include "core/sweep/segment.h"

namespace trapeze {

struct OwnedSegment {
  Segment segment;          // upper end first
  std::uint32_t owner = 0;  // the feature, by its position
};

/// All segments of the rings, feature by feature.
std::vector<OwnedSegment> segments_of(std::span<const Rings* const> features);

/// Sorts by upper end, then lower end, in sweep order, then by owner: segments that coincide become
/// neighbours in the array.
void sort_by_place(std::vector<OwnedSegment>& segments);

}  // namespace trapeze
