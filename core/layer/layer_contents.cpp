#include "core/layer/layer_contents.h"

namespace trapeze {

RingRange LayerContents::rings_of(std::uint32_t row) const {
  if (const auto moved = moved_outlines.find(row); moved != moved_outlines.end()) {
    return moved->second;
  }
  if (row >= outline_ends.size()) return {};
  return {row == 0 ? 0 : outline_ends[row - 1], outline_ends[row]};
}

BuiltUnitsView LayerContents::units() const {
  return {{feature_units.data(), feature_units.size()},
          {group_units.data(), group_units.size()},
          {group_members.data(), group_members.size()},
          {group_overlaps.data(), group_overlaps.size()}};
}

std::size_t LayerContents::count_vertices() const {
  std::size_t count = 0;
  for (const FeatureUnit& unit : feature_units) count += unit.vertices;
  for (const GroupUnit& unit : group_units) count += unit.vertices;
  return count;
}

}  // namespace trapeze
