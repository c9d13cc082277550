// A layer ready to be drawn: the trapezoids of all its polygons, where they are, and its features.
//
// Thread-safety: immutable; any number of threads may read.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/name_table.h"
#include "core/grid/rings.h"
#include "core/grid/tolerance.h"
#include "core/layer/feature_table.h"
#include "core/layer/grains.h"
#include "core/layer/layer_size.h"
#include "core/layer/overlaps.h"
#include "core/mesh/outline.h"
#include "core/mesh/trapezoid_mesh.h"

namespace trapeze {

struct LayerContents;  // the stored arrays

/// What becomes of polygons, and of holes, that are too small for a tolerance.
enum class SmallPolygons : std::uint8_t {
  dust,  // their area is kept as covered area where they were
  keep,  // the caller draws them large enough to be seen, see Layer::small_polygons
  drop,  // they are left out
};

inline constexpr NameTable<SmallPolygons, 3> kSmallPolygonsNames({
    {"drop", SmallPolygons::drop},
    {"dust", SmallPolygons::dust},
    {"keep", SmallPolygons::keep},
});

class Layer {
 public:
  static constexpr std::uint32_t kNoFeature = 0xffffffff;

  explicit Layer(std::unique_ptr<const LayerContents> contents);  // see LayerBuilder, layer_from
  ~Layer();
  Layer(const Layer&) = delete;
  Layer& operator=(const Layer&) = delete;

  const FeatureTable& features() const;
  /// The smallest box that holds all polygons; empty if there are none.
  const Box& bounds() const;
  const MeshView& mesh() const;
  /// By trapezoid of the mesh: the levels at which it is part of it; of dust, the resolutions.
  std::span<const Lifespan> lifespans() const;
  /// Of the edges and vertices of the mesh, those of dust left out.
  const OutlineView& outline() const;

  /// The part of the mesh that is asked for.
  struct Selection {
    Box box;
    Level level = 0;  // of tolerance
    /// The level of a quarter of a pixel: dust is merged within pixels of this size, however much
    /// greater the tolerance is.
    Level pixel_level = kLastLevel;
    SmallPolygons small = SmallPolygons::dust;

    /// Grains that are larger than a pixel, as the tolerance is: select() does not find them. None
    /// unless it is greater than a quarter of a pixel.
    GrainIndex::Births later_births() const;
  };

  /// Replaces `ranges` by the trapezoids of the mesh at the level that may touch the box, with or
  /// without those that stand for dust, as disjoint ranges in ascending order. Never leaves out a
  /// trapezoid whose interior meets the box; may name a few that do not. In a trapezoid of dust
  /// that stands for holes, left and right edges are swapped: its area is negative.
  ///
  /// A place that several features of a coverage have in common (FeatureOverlap::in_common()) has a
  /// trapezoid for each, one after the other, the uppermost last; see have_in_common() and
  /// keep_uppermost().
  void select(const Selection& selection, std::vector<TrapezoidRange>& ranges) const;

  /// Of places that features have in common, leaves the trapezoid of the uppermost feature only:
  /// for drawing all features alike, in which each place counts once. `ranges` as select() found
  /// them.
  void keep_uppermost(std::vector<TrapezoidRange>& ranges) const;

  /// Whether two of the trapezoids that select() finds are one place that two features have in
  /// common.
  bool have_in_common(std::uint32_t one, std::uint32_t other) const;

  /// Replaces `ranges` by the horizontal edges of the boundary at the level that may touch the box,
  /// as trapezoids without height whose left and right sides are the edge. All other edges of the
  /// boundary are sides of trapezoids that select() finds.
  void select_horizontal_edges(const Box& box, Level level,
                               std::vector<TrapezoidRange>& ranges) const;

  /// About how many trapezoids select() finds, see MeshIndex::estimate().
  std::uint64_t estimate_trapezoids(const Selection& selection) const;
  /// About how many select_horizontal_edges() finds.
  std::uint64_t estimate_horizontal_edges(const Selection& selection) const;

  /// What small polygons and holes left behind, feature by feature: the dust that select() finds,
  /// before any of it is merged, and the later_births().
  const GrainIndex& grains() const;

  /// Which features lie over each other.
  const OverlapTable& overlaps() const;
  /// False if there were too many to find them all: of the others, neither lies over the other.
  bool has_all_overlaps() const;

  /// True only if the ranges that were selected cover the whole box of the selection, so that it is
  /// filled without being drawn; may be false although they do.
  bool fill_box(const Selection& selection, std::span<const TrapezoidRange> ranges) const;

  /// Whether any of the trapezoids that were selected stands for dust.
  bool have_dust(std::span<const TrapezoidRange> ranges) const;

  /// Replaces `places` by boxes around what is left of the small polygons of the selection, several
  /// in one pixel being merged.
  void small_polygons(const Selection& selection, std::vector<Box>& places) const;

  /// The boundary of feature `row` as it was built, on the grid; appended to `rings`. Of one that
  /// is removed, as it was.
  void append_outline(std::uint32_t row, Rings& rings) const;

  /// The row, in features(), of the polygon that a trapezoid, or a horizontal edge, is a part of;
  /// kNoFeature for dust.
  std::uint32_t feature_of(std::uint32_t trapezoid) const;

  /// Whether the feature of that row is no longer there: see LayerPatcher.
  bool is_removed(std::uint32_t row) const;

  LayerSize size() const;

  /// Memory held by geometry and index, in bytes: heap, or mapped. Attributes are counted by
  /// features().memory().
  std::size_t memory() const;

  const LayerContents& contents() const { return *contents_; }  // used by arrays_of

 private:
  std::unique_ptr<const LayerContents> contents_;
};

}  // namespace trapeze
