// All that a layer holds, as flat arrays: to be stored, and mapped again without a copy.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/layer/feature_table.h"
#include "core/layer/layer.h"
#include "core/layer/layer_options.h"
#include "core/mesh/mesh_index.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// The arrays look at memory of something else.
struct LayerArrays {
  std::span<const Point> vertices;
  std::span<const MeshEdge> edges;
  // Of polygons, for level edges, of single motes, of merged ones.
  std::span<const MeshTrapezoid> trapezoids;
  std::span<const Lifespan> lifespans;
  std::span<const std::uint32_t> feature_of;  // of those of polygons and for level edges
  std::span<const MeshIndex::Entry> polygon_index;
  std::span<const MeshIndex::Entry> level_edge_index;
  std::span<const MeshIndex::Entry> mote_index;
  std::span<const MeshIndex::Entry> merged_mote_index;
  std::span<const FeatureGrain> grains;
  std::span<const Point> outline_points;
  std::span<const std::uint32_t> ring_ends;
  std::span<const std::uint32_t> outline_ends;
  FeatureTable::Cells cells;

  std::vector<Field> fields;
  std::uint64_t level_edges = 0;
  std::uint64_t single_motes = 0;
  LayerSize size;
  Box bounds;
  LayerOptions options;
};

/// The arrays of a layer, which must outlive their use.
LayerArrays arrays_of(const Layer& layer);

/// A layer that looks at the arrays and keeps `mapping` while it lives. Equal to the one that the
/// arrays were taken from: draws the same, answers the same.
///
/// Trusts nothing: looks at every item, on all cores, and throws std::invalid_argument in words if
/// an index leads nowhere or a trapezoid does not lie between its edges on the grid. A layer that
/// is returned can be drawn and asked for anything without reading beyond the arrays, whoever wrote
/// them. They must not change while the layer lives.
std::unique_ptr<Layer> layer_from(const LayerArrays& arrays, std::shared_ptr<const void> mapping);

}  // namespace trapeze
