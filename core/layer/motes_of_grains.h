// From the grains of a layer to motes, and from these to trapezoids.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/layer/dust.h"
#include "core/layer/grains.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// What small loops left behind where features are not told apart: a place that others cover is as
/// it was.
std::vector<Grain> uncovered(std::span<const FeatureGrain> grains);

/// By this key motes are in order for a MeshIndex.
std::uint64_t order_key(const Mote& mote);

/// The square of a mote as a trapezoid; one of negative area has its edges swapped.
void append_mote(const Mote& mote, std::vector<Point>& vertices, std::vector<MeshEdge>& edges,
                 std::vector<MeshTrapezoid>& trapezoids);

}  // namespace trapeze
