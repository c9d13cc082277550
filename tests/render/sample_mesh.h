// Meshes for tests of renderers, made by hand or at random, with known properties.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "core/mesh/trapezoid_mesh.h"

namespace trapeze::testing {

/// A mesh that owns its arrays. Every mesh has its own id.
class SampleMesh {
 public:
  SampleMesh();

  std::uint32_t add_vertex(std::int32_t x, std::int32_t y);
  std::uint32_t add_edge(Point upper, Point lower);
  /// Adds the region between two edges from one y to another.
  void add(std::uint32_t left, std::uint32_t right, std::int32_t top, std::int32_t bottom);
  /// Adds a rectangle, in cells.
  void add_box(std::int32_t min_x, std::int32_t min_y, std::int32_t max_x, std::int32_t max_y);

  MeshView view() const { return {id_, vertices_, edges_, trapezoids_}; }
  TrapezoidRange all() const { return {0, static_cast<std::uint32_t>(trapezoids_.size())}; }
  std::size_t size() const { return trapezoids_.size(); }
  /// The sum of the areas of all trapezoids, in square cells.
  long double area() const;

 private:
  std::uint64_t id_;
  std::vector<Point> vertices_;
  std::vector<MeshEdge> edges_;
  std::vector<MeshTrapezoid> trapezoids_;
};

/// The x of an edge at a height, computed in the widest floating-point type.
long double x_at(const MeshView& mesh, std::uint32_t edge, long double y);

/// About `count` disjoint trapezoids that fill about half of the box: between edges from its top to
/// its bottom that do not cross, cut at random heights. Many are slivers; some have no area.
SampleMesh random_strips(std::mt19937& random, const Box& box, int count);

/// `count` disjoint trapezoids, each alone in a square of a chessboard that covers the box.
SampleMesh random_scatter(std::mt19937& random, const Box& box, int count);

}  // namespace trapeze::testing
