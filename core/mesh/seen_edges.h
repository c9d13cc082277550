// Where the boundary of a feature is seen, of which parts are hidden by others that lie over it: as
// far as its inside is seen beside it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/trapezoid_mesh.h"
#include "core/mesh/visible_parts.h"

namespace trapeze {

/// A piece of an edge.
struct SeenEdge {
  std::uint32_t edge = 0;
  Point from;  // the end that is nearer to the upper vertex of the edge
  Point to;
  float share = 1;  // see TrapezoidPart

  friend bool operator==(const SeenEdge&, const SeenEdge&) = default;
};

/// What is visible of a feature in a box, and perhaps beyond.
struct VisibleInBox {
  std::span<const TrapezoidPart> parts;  // all that meet the box
  Box box;
};

/// Appends what is seen of the edges of the feature, which are those of `own`, in ascending order:
/// of edges that are sides of its visible parts. A piece is as long as can be. One that goes on
/// beyond the box goes on to the end of its edge, and edges that do not meet the box are left out:
/// so nothing depends on where trapezoids end outside of it.
void append_seen_sides(const MeshView& mesh, std::span<const std::uint32_t> own,
                       const VisibleInBox& visible, std::vector<SeenEdge>& seen);

/// Appends what is seen of a horizontal edge of the feature, likewise.
void append_seen_level_edge(const MeshView& mesh, std::uint32_t edge, const VisibleInBox& visible,
                            std::vector<SeenEdge>& seen);

}  // namespace trapeze
