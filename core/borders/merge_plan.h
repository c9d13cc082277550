// Which faces of a coverage become blocks, and at which tolerance (see merging.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/borders/coverage_options.h"
#include "core/borders/face_features.h"
#include "core/grid/grid.h"
#include "core/grid/ids.h"

namespace trapeze {

/// No wider gap is bridged. In cells: four pixels at zoom 11, 306 m at the equator. At coarser
/// zooms built-up areas are drawn as areas, and each bridge takes memory.
constexpr double kWidestBridge = 16384;

/// The box widened so that the boxes of two polygons that may become one block intersect.
Box widened_for_blocks(const Box& box);

constexpr std::uint32_t kMixedClass = 0xffffffff;

/// The faces of a coverage that become one, and when.
struct MergePlan {
  double ratio = 0;
  FaceId first_void = 0;  // faces from this one on are pieces of the void; those before belong to
                          // features
  /// The tolerance at which each piece is filled, in cells.
  std::vector<double> due;
  /// By face - 1, pieces included. kMixedClass equals no other class.
  std::vector<std::uint32_t> classes;

  bool is_void(FaceId face) const { return face == kOutside || face >= first_void; }
  bool is_piece(FaceId face) const { return face >= first_void; }
  double due_of(FaceId piece) const { return due[piece - first_void]; }
  bool are_of_one_class(FaceId a, FaceId b) const;
};

/// By face, 0 being the outside. kMixedClass for faces covered by features of several classes.
std::vector<std::uint32_t> classes_of_faces(const FaceFeatures& faces, const Merging& merging);

}  // namespace trapeze
