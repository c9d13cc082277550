// Where two states of a layer may look different, and in which tiles.
//
// Features are compared by their drawn geometry and by their attributes; their position in the
// layer matters only if others overlap them. For features that differ between both states, the
// sides of trapezoids are compared, so a place that is only divided differently but covered in the
// same way is no change.
//
// Thread-safety: may be called from any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/grid/grid.h"
#include "core/grid/tolerance.h"
#include "core/grid/web_mercator.h"
#include "core/layer/layer.h"

namespace trapeze {

struct LayerChanges {
  /// A side of a trapezoid: where, between two heights, the area to the east of it starts or stops
  /// being covered.
  struct Side {
    Point upper;  // of the edge
    Point lower;
    std::int32_t top = 0;  // of the trapezoid, as is the bottom
    std::int32_t bottom = 0;
    Lifespan lifespan;
    std::uint64_t outline = 0;  // distinguishes how an outline is drawn along the edge
    /// Weight of the feature, with a sign that depends on whether it covers and in which of the
    /// states. The sum over all sides to the west of a place is 0 unless the place looks different.
    std::uint64_t weight = 0;
  };
  /// Anything within it may look different.
  struct Place {
    Box box;
    Lifespan lifespan;
    bool is_dust = false;  // its lifespan is in resolutions, not tolerances
    /// If not empty, only images that show something of both boxes matter: where a feature is drawn
    /// over another, all outlines of the lower one are cut up.
    Box other = {};
  };

  std::vector<Side> sides;
  std::vector<Place> places;

  bool empty() const { return sides.empty() && places.empty(); }
};

/// Whether a feature with another id is a different feature. Many formats number features by their
/// position in a file.
enum class Ids : bool { do_not_matter, matter };

/// Empty if the layers look the same in every style or, if ids do not matter, in every style that
/// refers to no ids. The time depends on the sizes of the layers.
LayerChanges changes_between(const Layer& before, const Layer& after, Ids ids);

/// A layer, and the table of its features, which may be that of another layer: a layer without the
/// topology test has none of its own.
struct LayerWithFeatures {
  const Layer& layer;
  const FeatureTable& features;
};
LayerChanges changes_between(const LayerWithFeatures& before, const LayerWithFeatures& after,
                             Ids ids);

/// How tiles of one zoom are drawn.
struct TileDrawing {
  int zoom = 0;
  Level level = 0;        // of the tolerance
  Level pixel_level = 0;  // see Layer::Selection
  double reach = 0;       // cells: how far outlines and dust extend beyond their places

  friend bool operator==(const TileDrawing&, const TileDrawing&) = default;
};

/// The tiles that may look different, each once, by row and column. Throws std::length_error if
/// there are more than `most`.
std::vector<TileId> tiles_with_changes(const LayerChanges& changes, const TileDrawing& drawing,
                                       std::size_t most);

}  // namespace trapeze
