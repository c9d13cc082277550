#include "core/sweep/boundary.h"

#include <algorithm>
#include <limits>

namespace trapeze {
namespace {

/// The inverse of sweep_key().
Point point_of(std::uint64_t key) {
  constexpr std::uint32_t kBias = 0x80000000u;
  return {static_cast<std::int32_t>(static_cast<std::uint32_t>(key) ^ kBias),
          static_cast<std::int32_t>(static_cast<std::uint32_t>(key >> 32) ^ kBias)};
}

}  // namespace

void Boundary::begin_vertices(std::size_t count) {
  has_touches = false;
  vertices.clear();
  vertices.reserve(count + 2);
  vertices.push_back(
      Point{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::min()});
}

void Boundary::end_vertices() {
  vertices.push_back(
      Point{std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::max()});
}

/// Keys must come in ascending order.
VertexId Boundary::vertex_at(std::uint64_t key) {
  const Point p = point_of(key);
  const VertexId last(vertices.size() - 1);
  return last.value > 0 && vertices[last] == p ? last : vertices.push_back(p);
}

void Boundary::number_vertices(std::size_t count) {
  sort_by_key(sorted_, scratch_);
  vertex_of_.resize(count);
  begin_vertices(count);
  for (const auto& [key, index] : sorted_) vertex_of_[index] = vertex_at(key);
  end_vertices();
}

void Boundary::index_incident_edges() {
  // Two entries per edge, counted into place.
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

void Boundary::assign_sorted(std::span<const std::pair<Point, Point>> segments, unsigned threads) {
  const std::size_t count = segments.size();
  sorted_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    sorted_[i] = {sweep_key(segments[i].second), static_cast<std::uint32_t>(i)};
  }
  sort_by_key(sorted_, scratch_, threads);
  begin_vertices(count);
  edges.resize(count);
  std::size_t upper = 0;
  std::size_t lower = 0;
  while (lower < count) {
    const std::uint64_t key = sorted_[lower].key;
    const std::uint64_t upper_key = upper < count ? sweep_key(segments[upper].first) : key;
    if (upper < count && upper_key <= key) {
      edges[EdgeId(upper++)].upper = vertex_at(upper_key);
    } else {
      edges[EdgeId(sorted_[lower++].index)].lower = vertex_at(key);
    }
  }
  end_vertices();
  ring_vertex.clear();
  index_incident_edges();
}

void Boundary::keep(const std::vector<bool>& edges_to_keep) {
  constexpr std::uint32_t kUnused = 0;
  Table<VertexId, std::uint32_t> number;
  number.assign(vertices.size(), kUnused);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!edges_to_keep[i]) continue;
    const Ends ends = edges[EdgeId(i)];
    number[ends.upper] = number[ends.lower] = 1;
    edges[EdgeId(kept++)] = ends;
  }
  edges.resize(kept);
  std::uint32_t count = 0;
  for (std::size_t v = 1; v + 1 < vertices.size(); ++v) {
    if (number[VertexId(v)] == kUnused) continue;
    number[VertexId(v)] = ++count;
    vertices[VertexId(count)] = vertices[VertexId(v)];
  }
  vertices.resize(count + std::size_t{1});
  end_vertices();
  for (std::size_t i = 0; i < kept; ++i) {
    Ends& ends = edges[EdgeId(i)];
    ends = {VertexId(number[ends.upper]), VertexId(number[ends.lower])};
  }
  has_touches = false;
  ring_vertex.clear();
  index_incident_edges();
}

}  // namespace trapeze
