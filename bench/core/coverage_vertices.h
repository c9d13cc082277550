// How many vertices are left of a coverage at each zoom, and how many mapshaper leaves.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/server/trapeze_server.h"
#include "core/adapt/vertex_weight.h"
#include "core/layer/layer.h"

namespace trapeze {

/// What is left of the boundaries of a layer, dust apart.
struct VerticesLeft {
  std::size_t positions = 0;  // of vertices; one that several polygons have counts once
  std::size_t stored = 0;     // the same, but where polygons live apart each has its own
  std::size_t junctions = 0;  // of these, where three or more features meet, or two and the outside
};

VerticesLeft vertices_left(const Layer& layer, Level level);

/// Simplifies the same coverage with mapshaper, to which it is given untouched as the program
/// `trapeze` exports it; in a folder of its own.
class Mapshaper {
 public:
  /// Exports the file. Throws std::runtime_error if that fails.
  Mapshaper(const std::string& program, const std::string& file);

  /// Whether script/bootstrap has installed it.
  static bool is_installed();

  /// Positions of vertices that are left at each of the tolerances, in cells: by Douglas-Peucker at
  /// that distance, or by effective area, of which we take the square root as a distance. Throws
  /// std::runtime_error if mapshaper fails.
  std::vector<std::size_t> vertices_left(WeightRule rule,
                                         const std::vector<double>& tolerances) const;

 private:
  ScratchFolder folder_;
  std::string exported_;
};

}  // namespace trapeze
