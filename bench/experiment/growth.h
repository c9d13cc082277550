// How time and memory grow with the number of vertices of one polygon.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/experiment/screen.h"

namespace trapeze::experiment {

/// The figures for a coast-like polygon (wiggly_star in polygon_families.h).
struct GrowthPoint {
  std::size_t vertices = 0;
  double build_ms = 0;       // the plane sweep, from rings to the trapezoidal graph
  double weigh_ms = 0;       // Douglas-Peucker weights and the priority stack
  double generalize_ms = 0;  // all removals, down to the last triangle
  double undo_ms = 0;        // undoing all removals
  double load_ms = 0;        // from rings to a layer with its history
  double view_ms = 0;        // selecting and drawing all of it on 1600 x 1200 pixels, at 1/4 pixel
  std::size_t graph_memory = 0;  // of the graph and the log of its removals, bytes
  std::size_t layer_memory = 0;  // of the layer, bytes
};

/// Measures polygons of 10^3 to `most` vertices, two sizes per power of ten. Each figure is the
/// median of at least three measurements, or a single one if that takes seconds.
std::vector<GrowthPoint> measure_growth(std::size_t most, Screen& screen);

}  // namespace trapeze::experiment
