// The segments of several features, each with the feature whose boundary it belongs to.
#pragma once

#include <cstdint>
#include <span>

#include "core/grid/large_array.h"
#include "core/grid/rings.h"
#include "core/sweep/segment.h"

namespace trapeze {

struct OwnedSegment {
  Segment segment;          // upper end first
  std::uint32_t owner = 0;  // index of the feature
};

/// All segments of the rings, feature by feature.
LargeArray<OwnedSegment> segments_of(std::span<const Rings* const> features);

/// Appends the segments of one feature that lie in the box.
void append_segments(const Rings& rings, std::uint32_t owner, const Box& box,
                     LargeArray<OwnedSegment>& segments);

/// Orders by upper end, then lower end, in sweep order. Both segments have their upper end first.
bool precedes(const Segment& a, const Segment& b);

/// Sorts by place (see precedes()), then by owner: coinciding segments become neighbours in the
/// array. Runs on up to `threads` threads.
void sort_by_place(LargeArray<OwnedSegment>& segments, unsigned threads = 1);

}  // namespace trapeze
