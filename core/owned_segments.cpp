#include "core/owned_segments.h"

#include <algorithm>
#include <tuple>

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
  const auto key = [](const OwnedSegment& s) {
    const auto& [upper, lower] = s.segment;
    return std::tuple(upper.y, upper.x, lower.y, lower.x, s.owner);
  };
  std::sort(segments.begin(), segments.end(),
            [&key](const OwnedSegment& a, const OwnedSegment& b) { return key(a) < key(b); });
}

}  // namespace trapeze
