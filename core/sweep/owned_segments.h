// The segments of several features, each with the feature whose boundary it is a part of.
#pragma once

#include <cstdint>
#include <span>

#include "core/grid/large_array.h"
#include "core/grid/rings.h"
#include "core/sweep/segment.h"

namespace trapeze {

struct OwnedSegment {
  Segment segment;          // upper end first
  std::uint32_t owner = 0;  // the feature, by its position
};

/// All segments of the rings, feature by feature.
LargeArray<OwnedSegment> segments_of(std::span<const Rings* const> features);

/// Appends those of one feature that lie in the box.
void append_segments(const Rings& rings, std::uint32_t owner, const Box& box,
                     LargeArray<OwnedSegment>& segments);

/// In order of upper ends, then lower ends, in sweep order. Both with the upper end first.
bool precedes(const Segment& a, const Segment& b);

/// Sorts by place, see precedes(), then by owner: segments that coincide become
/// neighbours in the array. On up to `threads` threads.
void sort_by_place(LargeArray<OwnedSegment>& segments, unsigned threads = 1);

}  // namespace trapeze
