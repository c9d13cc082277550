// Properties of the boundary of a layer besides its edges, so that a piece of it is drawn in the
// same way everywhere: the size of the loop that an edge belongs to, and the distance of its ends
// along the loop.
//
// Thread-safety: immutable; any number of threads may read.
#pragma once

#include <cstdint>
#include <span>

#include "core/grid/tolerance.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// The extent of a loop (the diameter of the circle of the same area) on a logarithmic scale with
/// eight steps per octave: accurate to 4.5 %.
using LoopSize = std::uint8_t;
constexpr int kLoopSizes = 256;

/// Of an area in cells squared, >= 0.
LoopSize loop_size_of(double area);
/// In cells.
double extent_of(LoopSize size);

/// The length of the boundary from the beginning of a loop to a vertex, as drawn at a level: in
/// cells, modulo 2^32. 0 where a loop begins and where several meet: lengths restart there.
using Milestone = std::uint32_t;

/// A view of the arrays of a layer, or of a mapped file. Missing entries have size 255 and
/// milestone 0.
struct OutlineView {
  std::span<const LoopSize> loop_sizes;  // by edge: of the larger of the loops that it separates
  std::span<const std::uint32_t> milestone_ends;  // by vertex: one past its last milestone
  // The milestones of a vertex in ascending order of levels: each applies from its level up to that
  // of the next.
  std::span<const Milestone> milestones;
  std::span<const Level> milestone_levels;

  LoopSize loop_size(std::uint32_t edge) const {
    return edge < loop_sizes.size() ? loop_sizes[edge] : LoopSize{kLoopSizes - 1};
  }
  /// Precondition: the vertex is part of the boundary at the level.
  Milestone milestone(std::uint32_t vertex, Level level) const;
};

/// Lengths along the outline, in cells. Their difference is about the length of the edge and may be
/// negative.
struct AlongEdge {
  double upper = 0;  // at its upper vertex
  double lower = 0;
};

/// The lengths along the outline at the ends of an edge of the mesh at that level. Where two edges
/// meet they agree, except at the beginnings of loops and where loops meet.
AlongEdge along_edge(const MeshView& mesh, const OutlineView& outline, std::uint32_t edge,
                     Level level);

/// `fits` states whether the lengths `from` and `to` fit an edge of that length: dashes along it
/// are then no longer than they should be, and at least an eighth of that. `length` is the length
/// between them, negative if they decrease. Neither `from` nor `to` is 0.
struct Stretch {
  bool fits = false;
  double length = 0;
};
Stretch stretch_between(Milestone from, Milestone to, double edge_length);

}  // namespace trapeze
