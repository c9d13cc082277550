#include "core/mesh/trapezoid_mesh.h"

#include <atomic>

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

}  // namespace trapeze
