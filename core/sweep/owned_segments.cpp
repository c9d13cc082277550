#include "core/sweep/owned_segments.h"

#include <algorithm>
#include <cstdint>

#include "core/grid/radix_sort.h"
#include "core/sweep/boundary.h"

namespace trapeze {

LargeArray<OwnedSegment> segments_of(std::span<const Rings* const> features) {
  constexpr Box kEverything{kGridMin, kGridMin, kGridMax, kGridMax};
  LargeArray<OwnedSegment> segments;
  std::size_t count = 0;
  for (const Rings* rings : features) count += rings->points.size();
  segments.reserve(count);
  for (std::uint32_t owner = 0; owner < features.size(); ++owner) {
    append_segments(*features[owner], owner, kEverything, segments);
  }
  return segments;
}

void append_segments(const Rings& rings, std::uint32_t owner, const Box& box,
                     LargeArray<OwnedSegment>& segments) {
  const auto is_in_box = [&box](Point p) {
    return p.x >= box.min_x && p.x <= box.max_x && p.y >= box.min_y && p.y <= box.max_y;
  };
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const std::span<const Point> ring = rings[r];
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point a = ring[i];
      const Point b = ring[i + 1 < ring.size() ? i + 1 : 0];
      if (!is_in_box(a) || !is_in_box(b)) continue;
      segments.push_back({is_above(a, b) ? Segment{a, b} : Segment{b, a}, owner});
    }
  }
}

bool precedes(const Segment& a, const Segment& b) {
  return a.first != b.first ? is_above(a.first, b.first) : is_above(a.second, b.second);
}

void sort_by_place(LargeArray<OwnedSegment>& segments, unsigned threads) {
  LargeArray<KeyedIndex> order(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    order[i] = {sweep_key(segments[i].segment.first), static_cast<std::uint32_t>(i)};
  }
  LargeArray<KeyedIndex> scratch;
  sort_by_key(order, scratch, threads);
  LargeArray<OwnedSegment> sorted;
  sorted.reserve(segments.size());
  for (const KeyedIndex& item : order) sorted.push_back(segments[item.index]);
  // Sorts the few with the same upper end.
  for (std::size_t i = 0; i < sorted.size();) {
    const std::size_t begin = i;
    while (i < sorted.size() && order[i].key == order[begin].key) ++i;
    if (i == begin + 1) continue;
    std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin),
              sorted.begin() + static_cast<std::ptrdiff_t>(i),
              [](const OwnedSegment& a, const OwnedSegment& b) {
                const Point a_lower = a.segment.second;
                const Point b_lower = b.segment.second;
                return a_lower != b_lower ? is_above(a_lower, b_lower) : a.owner < b.owner;
              });
  }
  segments.swap(sorted);
}

}  // namespace trapeze
