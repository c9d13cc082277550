// The stored arrays of a layer; private to Layer, LayerBuilder and LayerArrays.
#pragma once

#include <cstdint>
#include <memory>

#include "core/grid/stored_array.h"
#include "core/layer/built_units.h"
#include "core/layer/feature_table.h"
#include "core/layer/grains.h"
#include "core/layer/layer_options.h"
#include "core/layer/layer_size.h"
#include "core/layer/overlaps.h"
#include "core/mesh/mesh_index.h"
#include "core/mesh/outline.h"

namespace trapeze {

struct LayerContents {
  std::shared_ptr<const void> mapping;  // owns the memory of the arrays that are views
  StoredArray<Point> vertices;
  StoredArray<MeshEdge> edges;
  StoredArray<MeshTrapezoid> trapezoids;
  StoredArray<Lifespan> lifespans;        // by trapezoid
  StoredArray<std::uint32_t> feature_of;  // by trapezoid, those of dust left out
  MeshView view;                          // of the arrays above
  StoredArray<LoopSize> loop_sizes;
  StoredArray<std::uint32_t> milestone_ends;
  StoredArray<Milestone> milestones;
  StoredArray<Level> milestone_levels;
  OutlineView outline;  // of these
  // Trapezoids of polygons come first, then those that stand for horizontal edges, then those of
  // single motes, then those of merged motes.
  MeshIndex polygon_index;
  MeshIndex horizontal_edge_index;
  MeshIndex mote_index;
  MeshIndex merged_mote_index;
  GrainIndex grains;
  OverlapTable overlaps;
  bool has_all_overlaps = true;
  LayerSize size;
  LayerOptions options;
  // The rings of all features, in order of rows, as in Rings.
  StoredArray<Point> outline_points;
  StoredArray<std::uint32_t> ring_ends;
  StoredArray<std::uint32_t> outline_ends;  // by row: the number of rings up to it and with it
  // As in BuiltUnitsView.
  StoredArray<FeatureUnit> feature_units;
  StoredArray<GroupUnit> group_units;
  StoredArray<GroupMember> group_members;
  StoredArray<GroupOverlap> group_overlaps;
  Box bounds;
  FeatureTable features;
};

}  // namespace trapeze
