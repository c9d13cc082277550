#include "core/sweep/owned_segments.h"

#include <algorithm>
#include <cstdint>

#include "core/sweep/noding.h"

namespace trapeze {

std::vector<OwnedSegment> segments_of(std::span<const Rings* const> features) {
  std::vector<OwnedSegment> segments;
  for (std::uint32_t owner = 0; owner < features.size(); ++owner) {
    for (const auto& [a, b] : segments_of(*features[owner])) {
      segments.push_back({is_above(a, b) ? Segment{a, b} : Segment{b, a}, owner});
    }
  }
  return segments;
}

void sort_by_place(std::vector<OwnedSegment>& segments) {
  const auto place = [](Point p) { return (static_cast<std::int64_t>(p.y) << 32) + p.x; };
  std::sort(segments.begin(), segments.end(), [&](const OwnedSegment& a, const OwnedSegment& b) {
    const auto [a_upper, a_lower] = a.segment;
    const auto [b_upper, b_lower] = b.segment;
    if (a_upper != b_upper) return place(a_upper) < place(b_upper);
    if (a_lower != b_lower) return place(a_lower) < place(b_lower);
    return a.owner < b.owner;
  });
}

}  // namespace trapeze
