// Converts a trapezoidal graph to polygons of the usual form: a shell with its holes.
//
// The links between inside nodes connect exactly the nodes that are reachable without crossing or
// touching the boundary, so every connected part of the inside is one polygon. The loops of the
// boundary are those of a graph built from the remaining rings (see boundary_loops.h): each is
// simple, and all its edges bound the same part from inside. Exactly one loop of a part encloses
// it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/borders/face_features.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/grid/rings.h"

namespace trapeze {

/// Polygons that are valid as OGC simple features, one after another. Their interiors are disjoint.
/// They touch each other only at vertices, and so do the rings of one polygon.
struct Polygons {
  /// The shell of each polygon, counterclockwise on a map with north up, then its holes, clockwise.
  /// Every ring begins at its topmost vertex.
  Rings rings;
  std::vector<std::uint32_t> ends;  // polygon i is rings ends[i - 1] .. ends[i] - 1

  /// Whether edges of the graph crossed, which is possible without the topological consistency
  /// test. They were then noded, and inside is even-odd.
  bool is_noded = false;
  /// Why the edges could not be noded, in which case there are no polygons; empty otherwise.
  std::string failure;

  std::size_t size() const { return ends.size(); }
  bool empty() const { return ends.empty(); }
  std::size_t first_ring(std::size_t polygon) const { return polygon == 0 ? 0 : ends[polygon - 1]; }
};

/// The polygons that the inside nodes of `graph` make up, adapted or not; none if there are no
/// inside nodes. Polygons are in sweep order of their topmost vertices, and so are the holes of
/// each. They depend only on the area covered by `graph`, not on its history.
Polygons polygons_of(const TrapezoidalGraph& graph);
/// The same for the area of rings, by even-odd. Cleans them in place (see clean_rings.h).
Polygons polygons_of(Rings& rings);

/// The same for each face of a coverage, by face - 1. Neighbours have identical edges along their
/// shared border.
std::vector<Polygons> polygons_of_faces(const TrapezoidalGraph& graph);
/// The same for each feature of a coverage, by position; features may overlap.
std::vector<Polygons> polygons_of_features(const TrapezoidalGraph& graph,
                                           const FaceFeatures& faces);

}  // namespace trapeze
