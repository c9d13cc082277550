// The invariants of core/README.md for the graph of any rings: after any removals, and when these
// are reverted.
#pragma once

#include <cstdint>

#include "core/grid/rings.h"
#include "core/layer/layer_options.h"
#include "tests/fuzz/input_share.h"

namespace trapeze::fuzzing {

/// The operations on a graph.
struct Operations {
  LayerOptions generalization;
  std::uint32_t seed = 0;             // for the order of removals and for tolerances
  double greatest_tolerance = 65536;  // cells
  Checks checks = Checks::all;
};

/// Builds the graph of the rings, removes corners in any order and reverts that, adapts the graph
/// to tolerances up and down, and records its history, as far as requested. Ends the program if an
/// invariant is broken. The rings, of at most some hundred points, are used as scratch memory.
void check_operators(Rings& rings, const Operations& operations);

}  // namespace trapeze::fuzzing
