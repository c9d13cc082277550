// Constrained Delaunay triangulation by CGAL, in the place of trapezoids.
#pragma once

#include <cstdint>
#include <memory>

#include "bench/experiment/trapezoid_list.h"
#include "core/grid/rings.h"

namespace trapeze::experiment {

/// Whether this program was built with CGAL.
bool has_triangulation();

/// Belongs to one thread.
class Triangulation {
 public:
  /// Throws std::runtime_error without CGAL.
  Triangulation();
  ~Triangulation();

  /// Appends the triangles that lie inside, by even-odd, of rings `first` .. `last` - 1 and that
  /// meet `view`; each is cut at the level of its middle vertex into two trapezoids. No two edges
  /// cross.
  void triangulate(const Rings& rings, std::uint32_t first, std::uint32_t last, const Box& view,
                   TrapezoidList& trapezoids);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace trapeze::experiment
