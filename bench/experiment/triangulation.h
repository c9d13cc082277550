// Constrained Delaunay triangulation by CGAL, instead of trapezoids.
#pragma once

#include <cstdint>
#include <memory>

#include "bench/experiment/trapezoid_list.h"
#include "core/grid/rings.h"

namespace trapeze::experiment {

/// Whether this program was built with CGAL.
bool has_triangulation();

/// Used by one thread.
class Triangulation {
 public:
  /// Throws std::runtime_error without CGAL.
  Triangulation();
  ~Triangulation();

  /// Appends the triangles, by the even-odd rule, of rings `first` .. `last` - 1 that are inside
  /// and intersect `view`; each is split at the level of its middle vertex into two trapezoids.
  /// Edges must not cross.
  void triangulate(const Rings& rings, std::uint32_t first, std::uint32_t last, const Box& view,
                   TrapezoidList& trapezoids);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trapeze::experiment
