// Features as built, before any vertex is removed: used to find which of them overlap when no layer
// has that information (see overlaps.h).
#pragma once

#include <cstdint>
#include <vector>

#include "core/borders/face_features.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/grid/grid.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// One thread at a time.
class FullDetail {
 public:
  /// Adds a graph without removals and the rows of the features that cover its faces. Each graph
  /// has a distinct `number`.
  void add(const TrapezoidalGraph& graph, const FaceFeatures& rows, std::uint32_t number);
  /// Adds everything that was added to another one.
  void add(FullDetail&& other);

  /// By row, up to the last one added: 1 if the feature overlaps another one, as the OverlapTable
  /// of a layer reports it. Depends neither on the order of the graphs nor on `threads`.
  std::vector<std::uint8_t> overlapping(unsigned threads) const;

 private:
  void note_row(std::uint32_t row, std::uint32_t graph);

  std::vector<Point> vertices_;
  std::vector<MeshEdge> edges_;
  std::vector<MeshTrapezoid> trapezoids_;
  std::vector<std::uint32_t> row_of_;          // by trapezoid
  std::vector<std::uint32_t> graph_of_;        // by row
  std::vector<Box> boxes_;                     // by row
  std::vector<std::uint32_t> rows_in_common_;  // rows that share a face with others
};

}  // namespace trapeze
