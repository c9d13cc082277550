// The contents of a layer as flat arrays, which can be stored and mapped again without copying.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/layer/built_units.h"
#include "core/layer/feature_table.h"
#include "core/layer/layer.h"
#include "core/layer/layer_options.h"
#include "core/mesh/mesh_index.h"
#include "core/mesh/outline.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

/// The spans are views of memory owned by others.
struct LayerArrays {
  std::span<const Point> vertices;
  std::span<const MeshEdge> edges;
  // In this order: polygons, horizontal edges, single motes, merged motes.
  std::span<const MeshTrapezoid> trapezoids;
  std::span<const Lifespan> lifespans;
  std::span<const std::uint32_t> feature_of;  // of the trapezoids of polygons and horizontal edges
  OutlineView outline;                        // of edges and vertices except those of dust
  std::span<const MeshIndex::Entry> polygon_index;
  std::span<const MeshIndex::Entry> horizontal_edge_index;
  std::span<const MeshIndex::Entry> mote_index;
  std::span<const MeshIndex::Entry> merged_mote_index;
  std::span<const FeatureGrain> grains;
  std::span<const FeatureOverlap> overlaps;
  bool has_all_overlaps = true;
  std::span<const Point> outline_points;
  std::span<const std::uint32_t> ring_ends;
  std::span<const std::uint32_t> outline_ends;
  BuiltUnitsView units;
  FeatureTable::Cells cells;

  std::vector<Field> fields;
  std::uint64_t horizontal_edges = 0;
  std::uint64_t single_motes = 0;
  LayerSize size;
  Box bounds;
  LayerOptions options;
};

/// The arrays of a layer, which must outlive their use. The layer was built whole (see
/// LayerPatcher).
LayerArrays arrays_of(const Layer& layer);

/// A layer that is a view of the arrays and keeps `mapping` alive while it lives. It equals the
/// layer from which the arrays were taken: it draws the same and returns the same results.
///
/// Checks every item, on all cores, and throws std::invalid_argument with the reason if an index is
/// out of range or a trapezoid does not lie between its edges on the grid. No use of the returned
/// layer reads beyond the arrays, whoever wrote them. They must not change during its lifetime.
std::unique_ptr<Layer> layer_from(const LayerArrays& arrays, std::shared_ptr<const void> mapping);

}  // namespace trapeze
