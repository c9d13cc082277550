// A layer ready to be drawn: the trapezoids of all its polygons, their spatial index, and its
// features.
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

/// How polygons and holes that are too small for a tolerance are treated.
enum class SmallPolygons : std::uint8_t {
  dust,  // their area is kept as covered area in place
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
  /// The bounding box of all polygons; empty if there are none.
  const Box& bounds() const;
  const MeshView& mesh() const;
  /// By trapezoid of the mesh: the levels at which it is part of the mesh; for dust, the
  /// resolutions.
  std::span<const Lifespan> lifespans() const;
  /// For the edges and vertices of the mesh, except those of dust.
  const OutlineView& outline() const;

  /// The requested part of the mesh.
  struct Selection {
    Box box;
    Level level = 0;  // of tolerance
    /// The level whose tolerance is a quarter of a pixel: dust is merged within pixels of this
    /// size, however much greater the tolerance is.
    Level pixel_level = kLastLevel;
    SmallPolygons small = SmallPolygons::dust;

    /// Grains that are larger than a pixel because the tolerance is; select() does not find them.
    /// None unless the tolerance is greater than a quarter of a pixel.
    GrainIndex::Births later_births() const;
  };

  /// Replaces `ranges` by the trapezoids of the mesh at the level that may touch the box, with or
  /// without those that represent dust, as disjoint ranges in ascending order. Never omits a
  /// trapezoid whose interior intersects the box; may include a few that do not. In a dust
  /// trapezoid that represents holes, left and right edges are swapped: its area is negative.
  ///
  /// A place that several features of a coverage share (FeatureOverlap::in_common()) has a
  /// trapezoid for each, one after the other, the uppermost last; see have_in_common() and
  /// keep_uppermost().
  void select(const Selection& selection, std::vector<TrapezoidRange>& ranges) const;

  /// Where features share a place, keeps only the trapezoid of the uppermost feature. For drawing
  /// all features alike, where each place counts once. `ranges` is the result of select().
  void keep_uppermost(std::vector<TrapezoidRange>& ranges) const;

  /// Whether two of the trapezoids found by select() are the same place, shared by two features.
  bool have_in_common(std::uint32_t one, std::uint32_t other) const;

  /// Replaces `ranges` by the horizontal edges of the boundary at the level that may touch the box,
  /// as trapezoids without height whose left and right sides are the edge. All other edges of the
  /// boundary are sides of trapezoids found by select().
  void select_horizontal_edges(const Box& box, Level level,
                               std::vector<TrapezoidRange>& ranges) const;

  /// Approximately how many trapezoids select() finds, see MeshIndex::estimate().
  std::uint64_t estimate_trapezoids(const Selection& selection) const;
  /// Approximately how many edges select_horizontal_edges() finds.
  std::uint64_t estimate_horizontal_edges(const Selection& selection) const;

  /// What small polygons and holes left behind, by feature: the dust found by select(), before any
  /// of it is merged, and the later_births().
  const GrainIndex& grains() const;

  /// The pairs of features that overlap.
  const OverlapTable& overlaps() const;
  /// False if there were too many overlaps to find them all. For pairs that were not found, neither
  /// feature counts as above the other.
  bool has_all_overlaps() const;

  /// True only if the selected ranges cover the whole box of the selection, so that it can be
  /// filled without drawing them. May be false although they do.
  bool fill_box(const Selection& selection, std::span<const TrapezoidRange> ranges) const;

  /// Whether any of the selected trapezoids represents dust.
  bool have_dust(std::span<const TrapezoidRange> ranges) const;

  /// Replaces `places` by boxes around the remains of the small polygons of the selection; several
  /// in one pixel are merged.
  void small_polygons(const Selection& selection, std::vector<Box>& places) const;

  /// Appends the boundary of feature `row` as built, on the grid, to `rings`. For a removed
  /// feature, the former boundary.
  void append_outline(std::uint32_t row, Rings& rings) const;

  /// The row, in features(), of the polygon to which a trapezoid or a horizontal edge belongs;
  /// kNoFeature for dust.
  std::uint32_t feature_of(std::uint32_t trapezoid) const;

  /// Whether the feature of that row has been removed: see LayerPatcher.
  bool is_removed(std::uint32_t row) const;

  LayerSize size() const;

  /// Memory held by geometry and index, in bytes: heap, or mapped. For attributes see
  /// features().memory().
  std::size_t memory() const;

  const LayerContents& contents() const { return *contents_; }  // used by arrays_of

 private:
  std::unique_ptr<const LayerContents> contents_;
};

}  // namespace trapeze
