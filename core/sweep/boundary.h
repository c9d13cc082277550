// The boundary of a polygon as the plane sweep needs it: vertices in sweep order, edges between
// them, and the edges that meet at each vertex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/ids.h"
#include "core/grid/rings.h"

namespace trapeze {

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
  /// Edges at vertex v: incident[first[v] .. first[v + 1]), in no order.
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

  /// Edge i runs from the i-th point of the rings to the next one of its ring. Rings are clean (see
  /// clean_rings.h).
  void assign(const Rings& rings);
  /// Edges between points; each edge once, its end points distinct.
  void assign(std::span<const std::pair<Point, Point>> segments);

 private:
  void index_incident_edges();

  struct SortKey {
    std::uint64_t key;  // sweep order
    std::uint32_t index;
  };
  void number_vertices(std::size_t count);

  std::vector<SortKey> sorted_;
  std::vector<VertexId> vertex_of_;  // by index of point
};

}  // namespace trapeze
