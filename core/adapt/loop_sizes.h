// Sizes of the loops of a boundary, by edge.
#pragma once

#include "core/borders/face_features.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/mesh/outline.h"

namespace trapeze {

/// Sets the size of every edge of the present graph to that of its loop. In a coverage, an edge may
/// be part of the boundaries of several features. Each boundary is split into the parts connected
/// at vertices, and the larger of these counts: the outline of a large feature is complete where it
/// has small neighbours. A feature has the same sizes next to others as by itself. Sizes of frame
/// edges are unspecified.
void measure_loop_sizes(const TrapezoidalGraph& graph, const FaceFeatures& faces,
                        Table<EdgeId, LoopSize>& sizes);

}  // namespace trapeze
