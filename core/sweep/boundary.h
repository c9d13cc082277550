// The boundary of a polygon in the form that the plane sweep needs: vertices in sweep order, edges
// between them, and the edges that meet at each vertex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/ids.h"
#include "core/grid/radix_sort.h"
#include "core/grid/rings.h"

namespace trapeze {

/// Ascending in sweep order.
constexpr std::uint64_t sweep_key(Point p) {
  constexpr std::uint32_t kBias = 0x80000000u;
  return std::uint64_t{static_cast<std::uint32_t>(p.y) ^ kBias} << 32 |
         (static_cast<std::uint32_t>(p.x) ^ kBias);
}

/// Positive if p lies right of the segment (on the sweep line through p), negative if left, 0 if on
/// its line.
constexpr std::int64_t side_of(Point upper, Point lower, Point p) {
  return -orientation(upper, lower, p);
}

/// Vertices 1 .. n are the distinct points in sweep order; vertices 0 and n + 1 belong to the frame
/// and have no edges here. Memory is kept for reuse. Thread-safety: none.
struct Boundary {
  struct Ends {
    VertexId upper;
    VertexId lower;
    friend auto operator<=>(const Ends&, const Ends&) = default;
  };

  Table<VertexId, Point> vertices;
  Table<EdgeId, Ends> edges;
  /// Edges at vertex v: incident[first[v] .. first[v + 1]), in no particular order.
  Table<VertexId, std::uint32_t> first;
  std::vector<EdgeId> incident;
  /// Whether some vertex has more than two edges: rings touch there.
  bool has_touches = false;
  /// For rings without touches: edge i leaves the i-th point of the rings, at this vertex.
  std::vector<VertexId> ring_vertex;

  std::span<const EdgeId> edges_at(VertexId v) const {
    return std::span<const EdgeId>(incident).subspan(first[v],
                                                     first[VertexId(v.value + 1)] - first[v]);
  }

  /// Edge i runs from the i-th point of the rings to the next point of its ring. Rings are clean
  /// (see clean_rings.h).
  void assign(const Rings& rings);
  /// Edges between points. Each edge occurs once and its end points are distinct.
  void assign(std::span<const std::pair<Point, Point>> segments);
  /// The same, faster, for segments with their upper ends first, sorted by these in sweep order.
  /// Runs on up to `threads` threads.
  void assign_sorted(std::span<const std::pair<Point, Point>> segments, unsigned threads = 1);

  /// Drops the edges for which it is false, and vertices that then have no edge. The rest keeps its
  /// order.
  void keep(const std::vector<bool>& edges_to_keep);

 private:
  void begin_vertices(std::size_t count);
  void end_vertices();
  VertexId vertex_at(std::uint64_t key);
  void index_incident_edges();
  void number_vertices(std::size_t count);

  LargeArray<KeyedIndex> sorted_;  // by sweep order
  LargeArray<KeyedIndex> scratch_;
  std::vector<VertexId> vertex_of_;  // by index of the point
};

}  // namespace trapeze
