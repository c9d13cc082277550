#include "core/layer/layer_part.h"

#include <algorithm>
#include <span>

#include "core/layer/layer_arrays.h"

namespace trapeze {
namespace {

void count(std::span<const Lifespan> lifespans, LevelCounts::Counts& counts) {
  std::array<std::int64_t, std::size_t{kLastLevel} + 2> changes = {};
  for (const Lifespan& lifespan : lifespans) {
    if (lifespan.born > kLastLevel || lifespan.born >= lifespan.dies) continue;
    ++changes[lifespan.born];
    --changes[std::min<std::size_t>(lifespan.dies, std::size_t{kLastLevel} + 1)];
  }
  std::int64_t alive = 0;
  for (std::size_t level = 0; level < counts.size(); ++level) {
    alive += changes[level];
    counts[level] = static_cast<std::uint64_t>(alive);
  }
}

}  // namespace

LevelCounts count_by_level(const Layer& layer) {
  const LayerArrays arrays = arrays_of(layer);
  const std::size_t edges = arrays.feature_of.size() - arrays.horizontal_edges;
  LevelCounts counts;
  count(arrays.lifespans.first(edges), counts.trapezoids);
  count(arrays.lifespans.subspan(edges, arrays.horizontal_edges), counts.horizontal_edges);
  count(arrays.lifespans.subspan(arrays.feature_of.size()), counts.motes);
  for (const FeatureGrain& grain : arrays.grains) {
    ++counts.grains[std::min<std::size_t>(grain.born, kLastLevel)];
  }
  counts.overlaps = layer.overlaps().pairs().size();
  counts.overlaps_along = layer.overlaps().pairs_along();
  return counts;
}

}  // namespace trapeze
