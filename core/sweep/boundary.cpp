#include "core/sweep/boundary.h"

#include <algorithm>
#include <limits>

namespace trapeze {
namespace {

/// Ascending in sweep order.
std::uint64_t sweep_key(Point p) {
  constexpr std::uint32_t kBias = 0x80000000u;
  return std::uint64_t{static_cast<std::uint32_t>(p.y) ^ kBias} << 32 |
         (static_cast<std::uint32_t>(p.x) ^ kBias);
}

}  // namespace

void Boundary::number_vertices(std::size_t count) {
  std::sort(sorted_.begin(), sorted_.end(), [](const SortKey& a, const SortKey& b) {
    return a.key != b.key ? a.key < b.key : a.index < b.index;
  });
  vertex_of_.resize(count);
  vertices.clear();
  vertices.reserve(count + 2);
  vertices.push_back(
      Point{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min()});
  has_touches = false;
  constexpr std::uint32_t kBias = 0x80000000u;
  for (std::size_t i = 0; i < sorted_.size(); ++i) {
    const std::uint64_t key = sorted_[i].key;
    if (i == 0 || sorted_[i - 1].key != key) {
      vertices.push_back(
          Point{static_cast<std::int32_t>(static_cast<std::uint32_t>(key) ^ kBias),
                static_cast<std::int32_t>(static_cast<std::uint32_t>(key >> 32) ^ kBias)});
    }
    vertex_of_[sorted_[i].index] = VertexId(vertices.size() - 1);
  }
  vertices.push_back(
      Point{std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max()});
}

void Boundary::index_incident_edges() {
  // Two entries an edge, counted into place.
  first.assign(vertices.size() + 1, 0);
  for (const Ends& e : edges) {
    ++first[VertexId(e.upper.value + 1)];
    ++first[VertexId(e.lower.value + 1)];
  }
  for (std::size_t v = 1; v <= vertices.size(); ++v) {
    const std::uint32_t degree = first[VertexId(v)];
    has_touches = has_touches || degree > 2;
    first[VertexId(v)] += first[VertexId(v - 1)];
  }
  incident.resize(2 * edges.size());
  // first[v] serves as the write position and is moved back afterwards.
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Ends e = edges[EdgeId(i)];
    incident[first[e.upper]++] = EdgeId(i);
    incident[first[e.lower]++] = EdgeId(i);
  }
  for (std::size_t v = vertices.size(); v > 0; --v) first[VertexId(v)] = first[VertexId(v - 1)];
  first[VertexId(0)] = 0;
}

void Boundary::assign(const Rings& rings) {
  const std::size_t count = rings.points.size();
  sorted_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    sorted_[i] = {sweep_key(rings.points[i]), static_cast<std::uint32_t>(i)};
  }
  number_vertices(count);
  edges.resize(count);
  std::size_t begin = 0;
  for (const std::uint32_t end : rings.ends) {
    for (std::size_t i = begin; i < end; ++i) {
      const VertexId a = vertex_of_[i];
      const VertexId b = vertex_of_[i + 1 < end ? i + 1 : begin];
      edges[EdgeId(i)] = a < b ? Ends{a, b} : Ends{b, a};
    }
    begin = end;
  }
  ring_vertex = vertex_of_;
  index_incident_edges();
}

void Boundary::assign(std::span<const std::pair<Point, Point>> segments) {
  sorted_.resize(2 * segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    sorted_[2 * i] = {sweep_key(segments[i].first), static_cast<std::uint32_t>(2 * i)};
    sorted_[2 * i + 1] = {sweep_key(segments[i].second), static_cast<std::uint32_t>(2 * i + 1)};
  }
  number_vertices(2 * segments.size());
  edges.resize(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const VertexId a = vertex_of_[2 * i];
    const VertexId b = vertex_of_[2 * i + 1];
    edges[EdgeId(i)] = a < b ? Ends{a, b} : Ends{b, a};
  }
  ring_vertex.clear();
  index_incident_edges();
}

}  // namespace trapeze
