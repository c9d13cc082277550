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

/// Appends what is seen of the edges of the feature, which are those of `own`, in ascending order:
/// of edges that are sides of `parts`, the feature's visible ones. A piece is as long as can be.
void append_seen_sides(const MeshView& mesh, std::span<const std::uint32_t> own,
                       std::span<const TrapezoidPart> parts, std::vector<SeenEdge>& seen);

/// Appends what is seen of a horizontal edge of the feature.
void append_seen_level_edge(const MeshView& mesh, std::uint32_t edge,
                            std::span<const TrapezoidPart> parts, std::vector<SeenEdge>& seen);

}  // namespace trapeze
