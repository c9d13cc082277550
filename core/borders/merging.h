// Polygons that lie near each other become blocks: the void between them is divided into pieces,
// each of which is filled when the tolerance has reached a part of the distance that it bridges.
//
// A triangle of the void (see void_mesh.h) is filled at a distance d if it can be a part of a set
// of triangles of which each
// * has two sides of at most d, or is no wider than d from a wall to the corner on the other side;
// * has all sides of at most d where the set ends and the void goes on.
// The sets of which that is true have a largest one, and that of a larger d holds that of a
// smaller. So there is one distance for each triangle: the least at which it is filled. Triangles
// that hang together and are filled at the same level are a piece, a face of the graph that no
// feature covers.
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

/// Divides the edges of polygons beside the void so that it can be filled between any two of them
/// that are near each other: where they are nearest, at hardly more than their distance (see
/// VoidMesh::kSlack), as a rule.
void divide_walls_for_bridges(VoidMesh& mesh, const TrapezoidalGraph& graph,
                              std::span<const std::uint32_t> class_of_face);

/// The distance of every triangle, in cells; any that is more than kWidestBridge where more is
/// bridged, beyond the hull, and where it is not between polygons of one class. `class_of_face` is
/// by face, 0 being outside.
std::vector<double> distances_to_fill(const VoidMesh& mesh, const TrapezoidalGraph& graph,
                                      std::span<const std::uint32_t> class_of_face);

/// A coverage with its void divided.
struct DividedVoid {
  std::vector<std::pair<Point, Point>> segments;  // the upper end first
  std::vector<std::pair<FaceId, FaceId>> sides;   // of each: the faces on its left and right
  MergePlan plan;
};

/// Of a coverage as it was built, whose faces up to first_void - 1 are of features; class_of_face
/// as above. None if there is nothing to bridge or it would take too long.
std::optional<DividedVoid> divide_void(const TrapezoidalGraph& graph, double ratio,
                                       FaceId first_void,
                                       std::span<const std::uint32_t> class_of_face);

}  // namespace trapeze
