// The history of a graph: every version of its inside trapezoids between the untouched polygon and
// the coarsest tolerance, each with its lifespan (see tolerance.h).
//
// The sequence of removals is carried out once, from fine to coarse. At every level, the versions
// of nodes that have changed since the previous level end, and new ones begin. Versions that exist
// at no level are not stored, which bounds the memory. Edges have their own versions, to which the
// versions of trapezoids refer.
#pragma once

#include <cstdint>
#include <vector>

#include "core/adapt/milestone_note.h"
#include "core/grid/area_moments.h"
#include "core/grid/tolerance.h"
#include "core/mesh/outline.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// A loop that became too small to keep: its area stays on the map, in place, as dust. A rectangle
/// of that area represents the place; a winding loop leaves several.
struct Grain {
  Axis axis;              // of the rectangle
  double area = 0;        // cells squared; negative if the loop was a hole
  Level born = 0;         // the first level without the loop
  std::uint32_t row = 0;  // row of the feature
  /// Whether other features cover the place before and after, so that nothing is lost or gained
  /// where features are not distinguished.
  bool is_covered = false;
};

/// A version of a horizontal edge, and when it is part of the boundary of a feature. The trapezoid
/// along it has no height and is not stored, so the edge would otherwise be lost.
struct HorizontalEdge {
  std::uint32_t edge = 0;
  Lifespan lifespan;
  std::uint32_t row = 0;  // row of the feature
  bool is_copy = false;   // copy of the previous one, for another feature
};

/// Versions of many graphs, one graph after another; indices are relative to the beginning of the
/// arrays.
struct History {
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<LoopSize> loop_sizes;  // by edge
  std::vector<MilestoneNote> milestones;
  std::vector<MeshTrapezoid> trapezoids;
  std::vector<Lifespan> lifespans;  // by trapezoid
  // By trapezoid: the row of its feature. A place covered by several features has a trapezoid for
  // each, one after the other, in order of rows.
  std::vector<std::uint32_t> rows;
  std::vector<HorizontalEdge> horizontal_edges;
  std::vector<Grain> grains;
};

}  // namespace trapeze
