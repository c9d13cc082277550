#include "core/layer/grains.h"

#include <utility>

namespace trapeze {

std::uint64_t order_key(const FeatureGrain& grain) {
  const Point middle{static_cast<std::int32_t>((std::int64_t{grain.from.x} + grain.to.x) / 2),
                     static_cast<std::int32_t>((std::int64_t{grain.from.y} + grain.to.y) / 2)};
  return std::uint64_t{static_cast<unsigned>(grain.born / kLevelsPerOctave)} << 32 |
         hilbert(middle);
}

GrainIndex::GrainIndex(StoredArray<FeatureGrain> grains)
    : grains_(std::move(grains)), blocks_((grains_.size() + kBlock - 1) / kBlock) {
  for (std::size_t i = 0; i < grains_.size(); ++i) {
    Block& block = blocks_[i / kBlock];
    block.box.include(grains_[i].box());
    block.min_born = std::min<std::uint32_t>(block.min_born, grains_[i].born);
    block.max_born = std::max<std::uint32_t>(block.max_born, grains_[i].born);
  }
}

std::size_t GrainIndex::count_near(const Box& box, Births births) const {
  const auto is_near = [&](const Block& block) { return block.meets(box, births); };
  const auto blocks = static_cast<std::size_t>(std::ranges::count_if(blocks_, is_near));
  return std::min(blocks * kBlock, grains_.size());
}

}  // namespace trapeze
