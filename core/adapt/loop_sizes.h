// How large the loops of a boundary are, edge by edge.
#pragma once

#include "core/borders/face_features.h"
#include "core/graph/trapezoidal_graph.h"
#include "core/mesh/outline.h"

namespace trapeze {

/// Sets the size of every edge of the graph as it is: that of its loop. In a coverage, an edge may
/// be part of the boundaries of several features; each of these consists of what hangs together at
/// vertices, and the larger one counts: the outline of a large feature is whole where it has small
/// neighbours. That of a feature is as large beside others as by itself. Sizes of the edges of the
/// frame are not specified.
void measure_loop_sizes(const TrapezoidalGraph& graph, const FaceFeatures& faces,
                        Table<EdgeId, LoopSize>& sizes);

}  // namespace trapeze
