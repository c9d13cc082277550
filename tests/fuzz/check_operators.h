// What must hold of the graph of any rings: the invariants of core/README.md, after any removals,
// and on the way back.
#pragma once

#include <cstdint>

#include "core/grid/rings.h"
#include "core/layer/layer_options.h"
#include "tests/fuzz/input_share.h"

namespace trapeze::fuzzing {

/// What is done to a graph.
struct Operations {
  LayerOptions generalization;
  std::uint32_t seed = 0;             // of the order of removals, and of tolerances
  double greatest_tolerance = 65536;  // cells
  Checks checks = Checks::all;
};

/// Builds the graph of the rings, removes corners in any order and takes that back, adapts it to
/// tolerances up and down, and records its history, as far as asked for. Ends the program if an
/// invariant is broken. The rings, of no more than some hundred points, are used as scratch memory.
void check_operators(Rings& rings, const Operations& operations);

}  // namespace trapeze::fuzzing
