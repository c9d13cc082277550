// The visible parts of the boundary of a feature whose interior is partly hidden by overlapping
// features: the boundary is visible where the interior beside it is.
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
  Point from;  // the end nearer to the upper vertex of the edge
  Point to;
  float share = 1;  // see TrapezoidPart

  friend bool operator==(const SeenEdge&, const SeenEdge&) = default;
};

/// The visible area of a feature in a box, and perhaps beyond.
struct VisibleInBox {
  std::span<const TrapezoidPart> parts;  // all parts that intersect the box
  Box box;
};

/// Appends the visible pieces of the edges of the feature (those of `own`, in ascending order) that
/// are sides of its visible parts. A piece is as long as possible. A piece that extends beyond the
/// box is continued to the end of its edge, and edges that do not intersect the box are left out.
/// So the result does not depend on where trapezoids end outside the box.
void append_seen_sides(const MeshView& mesh, std::span<const std::uint32_t> own,
                       const VisibleInBox& visible, std::vector<SeenEdge>& seen);

/// The same for the visible pieces of horizontal edges of the feature.
void append_seen_level_edges(const MeshView& mesh, std::span<const std::uint32_t> edges,
                             const VisibleInBox& visible, std::vector<SeenEdge>& seen);

}  // namespace trapeze
