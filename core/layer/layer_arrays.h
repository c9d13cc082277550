// The contents of a layer as flat arrays, which can be stored, and mapped again without copying.
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

/// The spans are views of memory that something else owns.
struct LayerArrays {
  std::span<const Point> vertices;
  std::span<const MeshEdge> edges;
  // In this order: of polygons, for horizontal edges, of single motes, of merged motes.
  std::span<const MeshTrapezoid> trapezoids;
  std::span<const Lifespan> lifespans;
  std::span<const std::uint32_t> feature_of;  // of those of polygons and for horizontal edges
  OutlineView outline;                        // of edges and vertices without those of dust
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

/// The arrays of a layer, which must outlive their use. It was built whole (see LayerPatcher).
LayerArrays arrays_of(const Layer& layer);

/// A layer that looks at the arrays and keeps `mapping` while it lives. Equal to the one that the
/// arrays were taken from: draws the same, answers the same.
///
/// Checks every item, on all cores, and throws std::invalid_argument, saying what is wrong, if an
/// index is out of range or a trapezoid does not lie between its edges on the grid. No use of a
/// layer that is returned reads beyond the arrays, whoever wrote them. They must not change during
/// its lifetime.
std::unique_ptr<Layer> layer_from(const LayerArrays& arrays, std::shared_ptr<const void> mapping);

}  // namespace trapeze
