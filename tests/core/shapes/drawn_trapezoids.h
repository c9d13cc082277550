// Trapezoids as they are drawn, by their coordinates, to compare a graph with its history.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <tuple>

#include "core/adapt/history.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/grid/tolerance.h"

namespace trapeze {

/// The row of a feature, the top and bottom y of a trapezoid, and the ends of its left and right
/// edge.
using Drawn = std::tuple<std::uint32_t, int, int, int, int, int, int, int, int, int, int>;

inline Drawn drawn(std::uint32_t row, int top, int bottom, Point lu, Point ll, Point ru, Point rl) {
  return {row, top, bottom, lu.x, lu.y, ll.x, ll.y, ru.x, ru.y, rl.x, rl.y};
}

/// The trapezoids of positive height inside the graph; face f is that of rows[f - 1].
inline std::multiset<Drawn> inside_of(const TrapezoidalGraph& g, const FaceFeatures& rows) {
  std::multiset<Drawn> found;
  for (const NodeId n : g.inside_nodes()) {
    const Node& node = g.node(n);
    const auto at = [&](Side s, Direction d) { return g.point(g.edge(node.edge[s]).end[d]); };
    const int top = g.point(node.end[kUp]).y;
    const int bottom = g.point(node.end[kDown]).y;
    if (top == bottom) continue;
    for (const std::uint32_t row : rows.of(g.face(node))) {
      found.insert(drawn(row, top, bottom, at(kLeft, kUp), at(kLeft, kDown), at(kRight, kUp),
                         at(kRight, kDown)));
    }
  }
  return found;
}

/// The trapezoids of the history that are alive at this level.
inline std::multiset<Drawn> alive_at(const History& h, Level level) {
  std::multiset<Drawn> found;
  for (std::size_t i = 0; i < h.trapezoids.size(); ++i) {
    if (!h.lifespans[i].contains(level)) continue;
    const MeshTrapezoid& t = h.trapezoids[i];
    const auto at = [&](std::uint32_t v) { return h.vertices[v]; };
    found.insert(drawn(h.rows[i], at(t.top).y, at(t.bottom).y, at(h.edges[t.left].upper),
                       at(h.edges[t.left].lower), at(h.edges[t.right].upper),
                       at(h.edges[t.right].lower)));
  }
  return found;
}

}  // namespace trapeze
