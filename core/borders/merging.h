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

#include "core/borders/void_mesh.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/grid/grid.h"

namespace trapeze {

/// Nothing is bridged that is wider, in cells: four pixels at zoom 11, 306 m at the equator. Towns
/// are areas by then, and each bridge takes memory.
constexpr double kWidestBridge = 16384;

/// Two boxes of polygons that may become one block meet if they are widened so.
Box widened_for_blocks(const Box& box);

/// What becomes a block.
struct Merging {
  /// The distance that is bridged, as a multiple of the tolerance; 0: none is.
  double ratio = 0;
  /// Only features of one class become one block: the class of each, or empty if all are of one.
  std::vector<std::uint32_t> classes = {};
};

/// The faces of a coverage that become one, and when.
struct MergePlan {
  double ratio = 0;
  FaceId first_void = 0;  // faces from this one on are pieces of the void, by feature those before
  /// The tolerance at which each piece is filled, in cells.
  std::vector<double> due;
  /// By face, less 1; of the pieces as well. kMixedClass is that of no other.
  std::vector<std::uint32_t> classes;

  bool is_void(FaceId face) const { return face == kOutside || face >= first_void; }
  bool is_piece(FaceId face) const { return face >= first_void; }
  bool are_of_one_class(FaceId a, FaceId b) const;
};

constexpr std::uint32_t kMixedClass = 0xffffffff;

/// Divides the edges of polygons beside the void so that it can be filled between any two of them
/// that are near each other: where they are nearest, at no more than the root of two times their
/// distance, as a rule.
void divide_walls_for_bridges(VoidMesh& mesh, const TrapezoidalGraph& graph,
                              std::span<const std::uint32_t> class_of_face);

/// The distance of every triangle, in cells; infinite beyond the hull and where it is not between
/// polygons of one class. `class_of_face` is by face, 0 being outside.
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
