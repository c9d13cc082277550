// Prefetches the memory that removals will read.
//
// Vertices are removed in order of weight, so successive ones lie anywhere on the map. In a large
// graph, the cache holds nothing about the next one, and each step from corner to edge to node to
// neighbour would wait for memory. Each of these functions prefetches one such step. Call it late
// enough after the previous one that the memory of that step has arrived. The functions change
// nothing, and may be called for corners that have been removed or never will be.
#pragma once

#include <cstddef>

#include "core/graph/trapezoidal_graph.h"
#include "core/grid/ids.h"

namespace trapeze {

// How many corners ahead each step is prefetched. The memory arrives after some hundred nanoseconds
// and is then still in the first-level cache.
constexpr std::size_t kCornerAhead = 24;
constexpr std::size_t kEdgesAhead = 16;
constexpr std::size_t kNodesAhead = 8;
constexpr std::size_t kNeighboursAhead = 4;

template <class IdType, class Record>
void fetch(const Table<IdType, Record>& table, IdType id) {
  if (id.is_none()) return;
  __builtin_prefetch(&table[id]);
  // Without this, GCC considers a function that only prefetches to have no effect and drops its
  // calls.
  __asm__ volatile("");
}

/// Call after fetch(graph.corners(), c).
inline void fetch_edges(const TrapezoidalGraph& graph, CornerId c) {
  const Corner& corner = graph.corner(c);
  if (!corner.is_alive()) return;
  fetch(graph.corners(), corner.prev);
  fetch(graph.corners(), corner.next);
  fetch(graph.edges(), corner.edge);
  fetch(graph.vertices(), corner.vertex);
}

/// Call after fetch_edges().
inline void fetch_nodes(const TrapezoidalGraph& graph, CornerId c) {
  const Corner& corner = graph.corner(c);
  if (!corner.is_alive()) return;
  for (const EdgeId e : {corner.edge, graph.corner(corner.prev).edge}) {
    const Edge& edge = graph.edge(e);
    for (const VertexId v : edge.end) fetch(graph.vertices(), v);
    for (const auto& along : edge.extreme) {
      for (const NodeId n : along) fetch(graph.nodes(), n);
    }
  }
}

/// Call after fetch_nodes(). Prefetches the neighbours of the nodes at the vertex.
inline void fetch_neighbours(const TrapezoidalGraph& graph, CornerId c) {
  const Corner& corner = graph.corner(c);
  if (!corner.is_alive()) return;
  for (const EdgeId e : {corner.edge, graph.corner(corner.prev).edge}) {
    const Edge& edge = graph.edge(e);
    const Direction back = edge.end[kUp] == corner.vertex ? kUp : kDown;
    for (const Side side : {kLeft, kRight}) {
      const Node& node = graph.node(edge.extreme[side][back]);
      fetch(graph.vertices(), node.end[opposite(back)]);
      fetch(graph.edges(), node.edge[side]);
      for (const auto& link : node.link) fetch(graph.nodes(), link[opposite(back)]);
    }
  }
}

}  // namespace trapeze
