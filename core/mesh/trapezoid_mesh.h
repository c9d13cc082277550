// The trapezoids of a whole layer as stored for drawing: flat, immutable arrays.
//
// A mesh holds every version of every trapezoid between the finest and the coarsest tolerance, each
// with its lifespan. The trapezoids alive at one level tile the polygons of the layer at that
// tolerance, without overlaps within one polygon. Only inside trapezoids are stored.
//
// Thread-safety: immutable after construction; any number of threads may read.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/tolerance.h"

namespace trapeze {

/// A straight piece of boundary: `upper` is above `lower` in sweep order.
struct MeshEdge {
  std::uint32_t upper = 0;  // index of a vertex
  std::uint32_t lower = 0;  // index of a vertex

  friend constexpr bool operator==(const MeshEdge&, const MeshEdge&) = default;
};

/// The area between two edges, from the y of vertex `top` down to the y of vertex `bottom`. Both
/// edges span that height. The four corners lie on the edges and are not stored. top.y == bottom.y
/// is possible (the sweep order breaks ties): such a trapezoid has no area.
struct MeshTrapezoid {
  std::uint32_t top = 0;     // index of a vertex
  std::uint32_t bottom = 0;  // index of a vertex
  std::uint32_t left = 0;    // index of an edge
  std::uint32_t right = 0;   // index of an edge

  friend constexpr bool operator==(const MeshTrapezoid&, const MeshTrapezoid&) = default;
};

/// The input of a renderer: a view of the arrays of a layer or of a mapped file.
struct MeshView {
  std::uint64_t id =
      0;  // unique in this process: equal ids mean equal contents, so uploads can be reused
  std::span<const Point> vertices;
  std::span<const MeshEdge> edges;
  std::span<const MeshTrapezoid> trapezoids;
};

/// The line along an edge that is not horizontal, in double precision.
class EdgeLine {
 public:
  EdgeLine(const MeshView& mesh, std::uint32_t edge)
      : EdgeLine(mesh.vertices[mesh.edges[edge].upper], mesh.vertices[mesh.edges[edge].lower]) {}
  EdgeLine(Point upper, Point lower)
      : x_(upper.x),
        y_(upper.y),
        slope_((static_cast<double>(lower.x) - upper.x) /
               (static_cast<double>(lower.y) - upper.y)) {}

  double x_at(double y) const { return x_ + (y - y_) * slope_; }

 private:
  double x_;
  double y_;
  double slope_;
};

/// Returns an id that no mesh of this process has had; never 0. Thread-safe.
std::uint64_t new_mesh_id();

/// Appends a rectangle to the arrays of a mesh: four vertices, two edges, one trapezoid.
void append_box(const Box& box, std::vector<Point>& vertices, std::vector<MeshEdge>& edges,
                std::vector<MeshTrapezoid>& trapezoids);

/// Appends a rectangle of any orientation: four vertices, four edges, and one to three trapezoids.
/// The corners are in order around it, rounded to cells. The rectangle must be many cells wide.
void append_rectangle(const std::array<Point, 4>& corners, std::vector<Point>& vertices,
                      std::vector<MeshEdge>& edges, std::vector<MeshTrapezoid>& trapezoids);

/// Trapezoids first, first + 1, ..., first + count - 1 of a mesh.
struct TrapezoidRange {
  std::uint32_t first = 0;
  std::uint32_t count = 0;

  friend constexpr bool operator==(const TrapezoidRange&, const TrapezoidRange&) = default;
};

/// Calls visit(index) for every trapezoid of the ranges.
template <typename Visit>
void for_each_trapezoid(std::span<const TrapezoidRange> ranges, const Visit& visit) {
  for (const TrapezoidRange& range : ranges) {
    for (std::uint32_t i = range.first; i < range.first + range.count; ++i) visit(i);
  }
}

/// Appends a trapezoid to ranges in ascending order, all below it.
inline void append_trapezoid(std::uint32_t trapezoid, std::vector<TrapezoidRange>& ranges) {
  if (!ranges.empty() && ranges.back().first + ranges.back().count == trapezoid) {
    ++ranges.back().count;
  } else {
    ranges.push_back({trapezoid, 1});
  }
}

}  // namespace trapeze
