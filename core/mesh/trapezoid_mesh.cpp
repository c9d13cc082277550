#include "core/mesh/trapezoid_mesh.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace trapeze {

std::uint64_t new_mesh_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

void append_box(const Box& box, std::vector<Point>& vertices, std::vector<MeshEdge>& edges,
                std::vector<MeshTrapezoid>& trapezoids) {
  const auto v = static_cast<std::uint32_t>(vertices.size());
  const auto e = static_cast<std::uint32_t>(edges.size());
  vertices.insert(vertices.end(), {{box.min_x, box.min_y},
                                   {box.min_x, box.max_y},
                                   {box.max_x, box.min_y},
                                   {box.max_x, box.max_y}});
  edges.insert(edges.end(), {{v, v + 1}, {v + 2, v + 3}});
  trapezoids.push_back({v, v + 3, e, e + 1});
}

void append_rectangle(const std::array<Point, 4>& corners, std::vector<Point>& vertices,
                      std::vector<MeshEdge>& edges, std::vector<MeshTrapezoid>& trapezoids) {
  const auto v = static_cast<std::uint32_t>(vertices.size());
  const auto e = static_cast<std::uint32_t>(edges.size());
  vertices.insert(vertices.end(), corners.begin(), corners.end());
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t next = (i + 1) % 4;
    const bool goes_down = is_above(corners[i], corners[next]);
    edges.push_back(goes_down ? MeshEdge{v + i, v + next} : MeshEdge{v + next, v + i});
  }
  std::array<std::uint32_t, 4> by_height{0, 1, 2, 3};
  std::ranges::sort(by_height, is_above, [&corners](std::uint32_t i) { return corners[i]; });
  for (std::size_t i = 0; i + 1 < by_height.size(); ++i) {
    const std::uint32_t top = by_height[i];
    const std::uint32_t bottom = by_height[i + 1];
    if (corners[top].y == corners[bottom].y) continue;
    const double y = (static_cast<double>(corners[top].y) + corners[bottom].y) / 2;
    std::vector<std::pair<double, std::uint32_t>> sides;  // their positions at that height
    for (std::uint32_t side = 0; side < 4; ++side) {
      const Point upper = vertices[edges[e + side].upper];
      const Point lower = vertices[edges[e + side].lower];
      if (upper.y < y && y < lower.y) {
        sides.emplace_back(EdgeLine(upper, lower).x_at(y), e + side);
      }
    }
    std::ranges::sort(sides);
    trapezoids.push_back({v + top, v + bottom, sides.front().second, sides.back().second});
  }
}

}  // namespace trapeze
