#include "core/layer/features_at.h"

#include <algorithm>

namespace trapeze {
namespace {

/// The cells around the point: the index may omit trapezoids that the point only touches.
Box around(Point point) {
  return {std::max(point.x, kGridMin + 1) - 1, std::max(point.y, kGridMin + 1) - 1,
          std::min(point.x, kGridMax - 1) + 1, std::min(point.y, kGridMax - 1) + 1};
}

}  // namespace

bool holds_point(const MeshView& mesh, const MeshTrapezoid& trapezoid, Point point) {
  // By y alone, not in sweep order: trapezoids without height are not stored in a mesh.
  if (point.y < mesh.vertices[trapezoid.top].y) return false;
  if (point.y >= mesh.vertices[trapezoid.bottom].y) return false;
  // Edges lead downwards, so the area to their right lies in the west.
  const auto side = [&](std::uint32_t edge) {
    const MeshEdge& e = mesh.edges[edge];
    return orientation(mesh.vertices[e.upper], mesh.vertices[e.lower], point);
  };
  return side(trapezoid.left) <= 0 && side(trapezoid.right) > 0;
}

std::vector<std::uint32_t> features_at(const Layer& layer, Point point, Level level) {
  std::vector<TrapezoidRange> ranges;
  layer.select({around(point), level, kLastLevel, SmallPolygons::drop}, ranges);
  const MeshView& mesh = layer.mesh();
  std::vector<std::uint32_t> rows;
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    if (!holds_point(mesh, mesh.trapezoids[i], point)) return;
    const std::uint32_t row = layer.feature_of(i);
    if (row != Layer::kNoFeature) rows.push_back(row);
  });
  std::ranges::sort(rows);
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

}  // namespace trapeze
