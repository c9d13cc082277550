// Nearby polygons become blocks: the void between them is divided into pieces, each of which is
// filled when the tolerance has reached a part of the distance that it bridges.
//
// A triangle of the void (see void_mesh.h) is filled at a distance d if it can be part of a set of
// triangles, each of which
// * has two sides of at most d, or is no wider than d from a wall to the opposite corner;
// * has only sides of at most d where the set ends and the void continues.
//
// There is a largest such set, and the set of a larger d contains that of a smaller one. So each
// triangle has one distance: the least at which it is filled. Connected triangles that are filled
// at the same level are a piece, a face of the graph that no feature covers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/borders/merge_plan.h"
#include "core/borders/void_mesh.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/grid/grid.h"

namespace trapeze {

/// Splits the edges of polygons beside the void so that the void can be filled between any two
/// nearby polygons where they are nearest, usually at hardly more than their distance (see
/// VoidMesh::kSlack).
void divide_walls_for_bridges(VoidMesh& mesh, const TrapezoidalGraph& graph,
                              std::span<const std::uint32_t> class_of_face);

/// The distance of every triangle, in cells: some value above kWidestBridge if more is bridged,
/// beyond the hull, and where the triangle is not between polygons of one class. `class_of_face` is
/// by face, 0 being the outside.
std::vector<double> distances_to_fill(const VoidMesh& mesh, const TrapezoidalGraph& graph,
                                      std::span<const std::uint32_t> class_of_face);

/// A coverage with its void divided.
struct DividedVoid {
  std::vector<std::pair<Point, Point>> segments;  // the upper end first
  std::vector<std::pair<FaceId, FaceId>> sides;   // of each segment: the faces on its left and
                                                  // right
  MergePlan plan;
};

/// Divides the void of a coverage as built, whose faces up to first_void - 1 belong to features;
/// class_of_face as above. Without segments if there is nothing to bridge, but polygons touch; none
/// if these do not touch either, or if it would take too long.
std::optional<DividedVoid> divide_void(const TrapezoidalGraph& graph, double ratio,
                                       FaceId first_void,
                                       std::span<const std::uint32_t> class_of_face);

}  // namespace trapeze
