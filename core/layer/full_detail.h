// Features as they were built, before anything is removed of them: to find out which lie over each
// other where there is no layer that knows it (see overlaps.h).
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
  /// A graph of which nothing has been removed, and the rows of the features that cover its faces.
  /// Each graph has a number of its own.
  void add(const TrapezoidalGraph& graph, const FaceFeatures& rows, std::uint32_t number);
  /// What another one has been told.
  void add(FullDetail&& other);

  /// By row, up to the last that was added: 1 if the feature covers a place that another one covers
  /// too, as OverlapTable has it of a layer. Depends neither on the order of graphs nor on
  /// `threads`.
  std::vector<std::uint8_t> overlapping(unsigned threads) const;

 private:
  void note_row(std::uint32_t row, std::uint32_t graph);

  std::vector<Point> vertices_;
  std::vector<MeshEdge> edges_;
  std::vector<MeshTrapezoid> trapezoids_;
  std::vector<std::uint32_t> row_of_;          // by trapezoid
  std::vector<std::uint32_t> graph_of_;        // by row
  std::vector<Box> boxes_;                     // by row
  std::vector<std::uint32_t> rows_in_common_;  // that cover a face together with others
};

}  // namespace trapeze
