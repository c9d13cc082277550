#include "core/mesh/loop_lengths.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace trapeze {
namespace {

double length_of(const MeshView& mesh, const MeshEdge& edge) {
  const Point a = mesh.vertices[edge.upper];
  const Point b = mesh.vertices[edge.lower];
  return std::hypot(static_cast<double>(b.x) - a.x, static_cast<double>(b.y) - a.y);
}

class LoopWalk {
 public:
  LoopWalk(const MeshView& mesh, std::span<const std::uint32_t> edges)
      : mesh_(mesh), edges_(edges), is_walked_(edges.size(), false), found_(edges.size()) {
    for (std::uint32_t i = 0; i < edges.size(); ++i) {
      ends_.emplace_back(mesh.edges[edges[i]].upper, i);
      ends_.emplace_back(mesh.edges[edges[i]].lower, i);
    }
    std::sort(ends_.begin(), ends_.end());
  }

  std::vector<LoopEdge> walk_all() {
    for (std::uint32_t i = 0; i < edges_.size(); ++i) {
      if (!is_walked_[i]) walk_from(i);
    }
    return std::move(found_);
  }

 private:
  void walk_from(std::uint32_t i) {
    double along = 0;
    std::uint32_t vertex = mesh_.edges[edges_[i]].upper;
    for (;;) {
      const MeshEdge& edge = mesh_.edges[edges_[i]];
      const bool leads_up = vertex == edge.lower;
      is_walked_[i] = true;
      found_[i] = {edges_[i], leads_up, along};
      along += length_of(mesh_, edge);
      vertex = leads_up ? edge.upper : edge.lower;
      const auto next = next_at(vertex);
      if (next == ends_.end()) return;
      i = next->second;
    }
  }

  // The first edge at the vertex that was not walked yet.
  std::vector<std::pair<std::uint32_t, std::uint32_t>>::const_iterator next_at(
      std::uint32_t vertex) const {
    auto end = std::lower_bound(ends_.begin(), ends_.end(), std::pair{vertex, std::uint32_t{0}});
    while (end != ends_.end() && end->first == vertex) {
      if (!is_walked_[end->second]) return end;
      ++end;
    }
    return ends_.end();
  }

  const MeshView& mesh_;
  std::span<const std::uint32_t> edges_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends_;  // vertex, position of the edge
  std::vector<bool> is_walked_;
  std::vector<LoopEdge> found_;
};

}  // namespace

std::vector<LoopEdge> measure_loops(const MeshView& mesh, std::vector<std::uint32_t> edges) {
  std::sort(edges.begin(), edges.end());
  return LoopWalk(mesh, edges).walk_all();
}

}  // namespace trapeze
