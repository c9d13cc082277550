#include "core/layer/motes_of_grains.h"

#include <cmath>
#include <utility>

#include "core/mesh/mesh_index.h"

namespace trapeze {

std::vector<Grain> uncovered(std::span<const FeatureGrain> grains) {
  std::vector<Grain> result;
  result.reserve(grains.size());
  for (const FeatureGrain& grain : grains) {
    if (grain.is_covered != 0) continue;
    result.push_back({{grain.from, grain.to}, grain.area(), grain.born, grain.row});
  }
  return result;
}

std::uint64_t order_key(const Mote& mote) {
  const Point p{static_cast<std::int32_t>(std::lround(mote.x)),
                static_cast<std::int32_t>(std::lround(mote.y))};
  return order_key(Box{p.x, p.y, p.x, p.y}, mote.lifespan);
}

void append_mote(const Mote& mote, std::vector<Point>& vertices, std::vector<MeshEdge>& edges,
                 std::vector<MeshTrapezoid>& trapezoids) {
  append_box(box_of_mote(mote.x, mote.y, std::abs(mote.area)), vertices, edges, trapezoids);
  if (mote.area < 0) std::swap(trapezoids.back().left, trapezoids.back().right);
}

}  // namespace trapeze
