#include "bench/experiment/douglas_peucker.h"

#include <cmath>

namespace trapeze::experiment {

void DouglasPeucker::simplify(std::uint32_t ring, double epsilon, std::vector<Chain>& chains) {
  const auto points = polygons_.rings[ring];
  const std::uint32_t second = polygons_.second_anchors[ring];
  farthest_.assign(points);
  pending_.push_back(measured(second, static_cast<std::uint32_t>(points.size())));
  pending_.push_back(measured(0, second));
  while (!pending_.empty()) {
    const Chain chain = pending_.back();
    pending_.pop_back();
    if (!chain.has_dropped() || chain.distance < epsilon) {
      chains.push_back(chain);
      continue;
    }
    pending_.push_back(measured(chain.split, chain.end));
    pending_.push_back(measured(chain.begin, chain.split));
  }
}

std::pair<Chain, Chain> DouglasPeucker::split(std::uint32_t ring, const Chain& chain) {
  farthest_.assign(polygons_.rings[ring]);
  return {measured(chain.begin, chain.split), measured(chain.split, chain.end)};
}

Chain DouglasPeucker::measured(std::uint32_t begin, std::uint32_t end) {
  if (end - begin < 2) return {.begin = begin, .end = end};
  const FarthestVertex::Found found = farthest_.find(begin, end);
  return {.begin = begin,
          .end = end,
          .split = static_cast<std::uint32_t>(found.vertex),
          .distance = std::sqrt(found.squared)};
}

}  // namespace trapeze::experiment
