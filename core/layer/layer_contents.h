// The stored arrays of a layer; private to Layer, LayerBuilder and LayerArrays.
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

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

/// Consecutive trapezoids of the mesh, grouped by what they represent, in this order.
struct MeshSegment {
  MeshIndex polygons;
  MeshIndex horizontal_edges;
  MeshIndex motes;  // single ones
  MeshIndex merged_motes;
};

/// Consecutive rings: from `begin` up to, but not including, `end`.
struct RingRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

struct LayerContents {
  const MeshSegment& first_segment() const { return *segments.front(); }
  /// Whether the layer consists only of content that was built whole.
  bool is_whole() const { return segments.size() == 1; }
  /// The rings of the feature as built; empty range if there are none.
  RingRange rings_of(std::uint32_t row) const;
  BuiltUnitsView units() const;
  /// The number of vertices of the graphs from which the layer was built.
  std::size_t count_vertices() const;

  std::shared_ptr<const void> mapping;  // owns the memory of the arrays that are views
  StoredArray<Point> vertices;
  StoredArray<MeshEdge> edges;
  StoredArray<MeshTrapezoid> trapezoids;
  StoredArray<Lifespan> lifespans;  // by trapezoid
  // By trapezoid. Dust at the end is left out; other dust has no feature.
  StoredArray<std::uint32_t> feature_of;
  MeshView view;  // of the arrays above
  StoredArray<LoopSize> loop_sizes;
  StoredArray<std::uint32_t> milestone_ends;
  StoredArray<Milestone> milestones;
  StoredArray<Level> milestone_levels;
  OutlineView outline;  // of the edges and vertices above
  // At least one, in order; a layer that was built whole has one. Layers may share them.
  std::vector<std::shared_ptr<const MeshSegment>> segments;
  GrainIndex grains;
  OverlapTable overlaps;
  bool has_all_overlaps = true;
  LayerSize size;
  LayerOptions options;
  // The rings of all features, in order of rows, as in Rings.
  StoredArray<Point> outline_points;
  StoredArray<std::uint32_t> ring_ends;
  StoredArray<std::uint32_t> outline_ends;  // by row: the number of rings up to and including it
  // In a layer in which features were replaced: the rings of replaced and of new features, by row.
  std::unordered_map<std::uint32_t, RingRange> moved_outlines;
  std::vector<bool> is_removed;  // by row; empty if none is removed
  // As in BuiltUnitsView.
  StoredArray<FeatureUnit> feature_units;
  StoredArray<GroupUnit> group_units;
  StoredArray<GroupMember> group_members;
  StoredArray<GroupOverlap> group_overlaps;
  Box bounds;
  FeatureTable features;
};

}  // namespace trapeze
