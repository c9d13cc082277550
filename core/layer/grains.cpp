#include "core/layer/grains.h"

#include <utility>

namespace trapeze {

void sort_for_index(std::vector<FeatureGrain>& grains) {
  const auto key = [](const FeatureGrain& grain) {
    const Point middle{static_cast<std::int32_t>((std::int64_t{grain.from.x} + grain.to.x) / 2),
                       static_cast<std::int32_t>((std::int64_t{grain.from.y} + grain.to.y) / 2)};
    return std::uint64_t{grain.born / kLevelsPerOctave} << 32 | hilbert(middle);
  };
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
  order.reserve(grains.size());
  for (std::size_t i = 0; i < grains.size(); ++i) {
    order.emplace_back(key(grains[i]), static_cast<std::uint32_t>(i));
  }
  std::sort(order.begin(), order.end());
  std::vector<FeatureGrain> sorted;
  sorted.reserve(grains.size());
  for (const auto& [unused, i] : order) sorted.push_back(grains[i]);
  grains.swap(sorted);
}

GrainIndex::GrainIndex(StoredArray<FeatureGrain> grains)
    : grains_(std::move(grains)), blocks_((grains_.size() + kBlock - 1) / kBlock) {
  for (std::size_t i = 0; i < grains_.size(); ++i) {
    Block& block = blocks_[i / kBlock];
    block.box.include(grains_[i].box());
    block.min_born = std::min(block.min_born, grains_[i].born);
    block.max_born = std::max(block.max_born, grains_[i].born);
  }
}

std::size_t GrainIndex::count_near(const Box& box, Births births) const {
  const auto is_near = [&](const Block& block) { return block.meets(box, births); };
  const auto blocks = static_cast<std::size_t>(std::ranges::count_if(blocks_, is_near));
  return std::min(blocks * kBlock, grains_.size());
}

}  // namespace trapeze
