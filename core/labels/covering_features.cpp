#include "core/labels/covering_features.h"

#include <algorithm>
#include <utility>

#include "core/grid/ring_box.h"
#include "core/layer/built_units.h"

namespace trapeze {
namespace {

constexpr std::size_t kMostPoints = std::size_t{1} << 22;  // kept in each of the two maps

}  // namespace

CoveringFeature::CoveringFeature(Rings rings) : rings_(std::move(rings)) {
  digest_ = digest_of(rings_);
  next_.resize(rings_.points.size());
  std::uint32_t begin = 0;
  for (std::size_t i = 0; i < rings_.size(); ++i) {
    const std::uint32_t end = rings_.ends[i];
    for (std::uint32_t k = begin; k < end; ++k) next_[k] = k + 1 == end ? begin : k + 1;
    box_.include(box_of(rings_[i]));
    if (end > begin) area_ = std::max(area_, area_of_ring(rings_[i]));
    begin = end;
  }
  by_height_.sort(rings_.points.size(), box_.min_y, box_.max_y,
                  [this](std::uint32_t side) { return heights_of(side); });
}

SidesByHeight::Heights CoveringFeature::heights_of(std::uint32_t side) const {
  return SidesByHeight::between(rings_.points[side], rings_.points[next_[side]]);
}

std::shared_ptr<const CoveringFeature> CoveringFeatures::at(std::uint32_t row) {
  if (auto found = find(row)) return found;
  Rings rings;
  layer_.append_outline(row, rings);
  auto feature = std::make_shared<const CoveringFeature>(std::move(rings));
  const std::scoped_lock lock(mutex_);
  keep(row, feature);
  return feature;
}

std::shared_ptr<const CoveringFeature> CoveringFeatures::find(std::uint32_t row) {
  const std::scoped_lock lock(mutex_);
  if (const auto found = recent_.find(row); found != recent_.end()) return found->second;
  const auto found = older_.find(row);
  if (found == older_.end()) return nullptr;
  auto feature = found->second;
  keep(row, feature);
  return feature;
}

void CoveringFeatures::keep(std::uint32_t row,
                            const std::shared_ptr<const CoveringFeature>& feature) {
  if (!recent_.emplace(row, feature).second) return;
  recent_points_ += feature->point_count();
  if (recent_points_ <= kMostPoints) return;
  older_ = std::exchange(recent_, {});
  recent_points_ = 0;
}

}  // namespace trapeze
