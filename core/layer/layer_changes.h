// What may look different in one state of a layer than in another, and in which tiles.
//
// Features are compared by what is drawn of them and by their attributes: not by where they stand
// in the layer, unless others lie over them. Of those that are not the same in both states,
// the sides of trapezoids are compared, so that what was cut otherwise but covers the same place in
// the same way is no change.
//
// Thread-safety: any thread.
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
  /// A side of a trapezoid: what lies east of it between two heights is covered, or is not.
  struct Side {
    Point upper;  // of the edge
    Point lower;
    std::int32_t top = 0;  // of the trapezoid
    std::int32_t bottom = 0;
    Lifespan lifespan;
    std::uint64_t outline = 0;  // tells apart how an outline is drawn along the edge
    /// Of the feature, with a sign that says whether it covers, and in which of the states: the sum
    /// over all sides to the west of a place is 0 unless the place looks different.
    std::uint64_t weight = 0;
  };
  /// Anything within it may look different.
  struct Place {
    Box box;
    Lifespan lifespan;
    bool is_dust = false;  // its lifespan is of the resolution, not of the tolerance
    /// If it is not empty, only pictures matter that show something of both boxes: where a feature
    /// lies over another, all of their outlines is cut up.
    Box other = {};
  };

  std::vector<Side> sides;
  std::vector<Place> places;

  bool empty() const { return sides.empty() && places.empty(); }
};

/// Whether a feature with another id is another one. Many formats number features as they stand in
/// a file.
enum class Ids : bool { do_not_matter, matter };

/// Nothing if the layers look the same in every style, or if ids do not matter, in every one that
/// names none. Takes time by their sizes.
LayerChanges changes_between(const Layer& before, const Layer& after, Ids ids);

/// How tiles of one zoom are drawn.
struct TileDrawing {
  int zoom = 0;
  Level level = 0;        // of the tolerance
  Level pixel_level = 0;  // see Layer::Selection
  double reach = 0;       // cells, of outlines and dust, beyond their places

  friend bool operator==(const TileDrawing&, const TileDrawing&) = default;
};

/// The tiles that may look different, each once, by row and column. Throws std::length_error if
/// there are more than `most`.
std::vector<TileId> tiles_with_changes(const LayerChanges& changes, const TileDrawing& drawing,
                                       std::size_t most);

}  // namespace trapeze
