// Converts the grains of a layer to motes, and motes to trapezoids.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/layer/dust.h"
#include "core/layer/grains.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// What small loops left behind, for drawing that does not distinguish features: a place covered by
/// others is unchanged.
std::vector<Grain> uncovered(std::span<const FeatureGrain> grains);

/// Sorts motes for a MeshIndex.
std::uint64_t order_key(const Mote& mote);

/// Appends the square of a mote as a trapezoid. For negative area, its edges are swapped.
void append_mote(const Mote& mote, std::vector<Point>& vertices, std::vector<MeshEdge>& edges,
                 std::vector<MeshTrapezoid>& trapezoids);

}  // namespace trapeze
