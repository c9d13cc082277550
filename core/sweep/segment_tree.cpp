#include "core/sweep/segment_tree.h"

#include "core/grid/hilbert.h"

namespace trapeze {

std::vector<std::pair<std::uint32_t, std::uint32_t>> order_by_place(
    const std::vector<Segment>& segments) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> places;
  places.reserve(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    places.emplace_back(hilbert(segments[i].first), static_cast<std::uint32_t>(i));
  }
  std::sort(places.begin(), places.end());
  return places;
}

}  // namespace trapeze
