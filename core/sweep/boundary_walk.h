// Walks along a boundary from edge to edge and stores the corners.
#pragma once

#include "core/graph/trapezoidal_graph.h"
#include "core/sweep/boundary.h"

namespace trapeze {

struct BoundaryWalk {
  bool is_loop;   // its last corner leads to its first
  CornerId last;  // has no next corner if the walk is no loop
  VertexId end;   // where the edge of `last` ends
};

/// Walks from `start` along `first`, and then along partner(v, e), the edge by which the walk
/// leaves v after arriving by e, until there is none or it is `first` again. The corner left by
/// edge i is corner i; each corner is linked to the previous and the next one.
template <typename Partner>
BoundaryWalk walk_boundary(const Boundary& boundary, VertexId start, EdgeId first,
                           const Partner& partner, Table<CornerId, Corner>& corners) {
  VertexId v = start;
  EdgeId e = first;
  CornerId last;
  do {
    const CornerId c(e.value);
    corners[c].vertex = v;
    corners[c].edge = e;
    corners[c].prev = last;
    if (!last.is_none()) corners[last].next = c;
    last = c;
    v = boundary.edges[e].upper == v ? boundary.edges[e].lower : boundary.edges[e].upper;
    e = partner(v, e);
  } while (!e.is_none() && e != first);
  if (e.is_none()) return {false, last, v};
  corners[last].next = CornerId(first.value);
  corners[CornerId(first.value)].prev = last;
  return {true, last, v};
}

}  // namespace trapeze
