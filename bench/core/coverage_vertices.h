// How many vertices of a coverage remain at each zoom, and how many mapshaper leaves.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/server/trapeze_server.h"
#include "core/adapt/vertex_weight.h"
#include "core/layer/layer.h"

namespace trapeze {

/// What remains of the boundaries of a layer, without dust.
struct VerticesLeft {
  std::size_t positions = 0;  // of vertices; vertices shared by several polygons count once
  std::size_t stored = 0;     // the same, but separate polygons each have their own
  std::size_t junctions = 0;  // positions where three or more features meet, or two and the outside
};

VerticesLeft vertices_left(const Layer& layer, Level level);

/// Simplifies the same coverage with mapshaper, from an unsimplified export by the program
/// `trapeze`, in a folder of its own.
class Mapshaper {
 public:
  /// Exports the file. Throws std::runtime_error if that fails.
  Mapshaper(const std::string& program, const std::string& file);

  /// Whether script/bootstrap has installed it.
  static bool is_installed();

  /// The number of vertex positions that remain at each of the tolerances, in cells: by
  /// Douglas-Peucker at that distance, or by effective area, whose square root we use as a
  /// distance. Throws std::runtime_error if mapshaper fails.
  std::vector<std::size_t> vertices_left(WeightRule rule,
                                         const std::vector<double>& tolerances) const;

 private:
  ScratchFolder folder_;
  std::string exported_;
};

}  // namespace trapeze
