// The trapezoids of a whole layer as they are stored for drawing: flat, immutable arrays.
//
// A mesh holds every version that any trapezoid ever had between the finest and the coarsest
// tolerance, each with its lifespan; the trapezoids alive at one level tile the polygons of the
// layer at that tolerance, without overlap (inside one polygon). Only inside trapezoids are stored.
//
// Thread-safety: immutable after construction, any number of threads may read.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/tolerance.h"

namespace trapeze {

/// A non-horizontal (in sweep order) straight piece of boundary: `upper` is above `lower`.
struct MeshEdge {
  std::uint32_t upper = 0;  // index of a vertex
  std::uint32_t lower = 0;  // index of a vertex

  friend constexpr bool operator==(const MeshEdge&, const MeshEdge&) = default;
};

/// The region between two edges, from the level of vertex `top` down to the level of vertex
/// `bottom`. Both edges span the whole height; corners lie where edges and levels meet and are not
/// stored. top.y == bottom.y is possible (the sweep order breaks ties): such a trapezoid has no
/// area.
struct MeshTrapezoid {
  std::uint32_t top = 0;     // index of a vertex
  std::uint32_t bottom = 0;  // index of a vertex
  std::uint32_t left = 0;    // index of an edge
  std::uint32_t right = 0;   // index of an edge

  friend constexpr bool operator==(const MeshTrapezoid&, const MeshTrapezoid&) = default;
};

/// What a renderer draws from; looks at memory owned by a TrapezoidMesh (or a mapped file).
struct MeshView {
  std::uint64_t id = 0;  // unique in this process: equal ids mean equal contents, for uploads
  std::span<const Point> vertices;
  std::span<const MeshEdge> edges;
  std::span<const MeshTrapezoid> trapezoids;
};

/// An id that no mesh of this process has had; never 0. Thread-safe.
std::uint64_t new_mesh_id();

/// Appends a rectangle to the arrays of a mesh: four vertices, two edges, one trapezoid.
void append_box(const Box& box, std::vector<Point>& vertices, std::vector<MeshEdge>& edges,
                std::vector<MeshTrapezoid>& trapezoids);

/// Trapezoids first, first + 1, ..., first + count - 1 of a mesh.
struct TrapezoidRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;

  friend constexpr bool operator==(const TrapezoidRange&, const TrapezoidRange&) = default;
};

/// Calls visit(trapezoid), its number, for every one of the ranges.
template <typename Visit>
void for_each_trapezoid(std::span<const TrapezoidRange> ranges, const Visit& visit) {
  for (const TrapezoidRange& range : ranges) {
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) visit(i);
  }
}

}  // namespace trapeze
