// Verifies the invariants of a trapezoidal graph, numbered as in core/README.md.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/graph/trapezoidal_graph.h"

namespace trapeze {

/// The first violation found, beginning with the number of the invariant ("I4: ..."), or an empty
/// string if there is none. O(n log n).
std::string check_graph(const TrapezoidalGraph& graph);

/// A trapezoid by its geometry alone, independent of numbering: top and bottom vertex, left and
/// right edge (upper and lower end each; frame edges are empty), face.
struct PlainTrapezoid {
  Point top, bottom;
  Point left[2], right[2];
  FaceId face = kOutside;
  friend bool operator==(const PlainTrapezoid&, const PlainTrapezoid&) = default;
};

/// All trapezoids of a graph in a canonical order. Two graphs are the same trapezoidation exactly
/// if these are equal, because the trapezoidation of a given set of rings is unique.
std::vector<PlainTrapezoid> plain_trapezoids(const TrapezoidalGraph& graph);

}  // namespace trapeze
