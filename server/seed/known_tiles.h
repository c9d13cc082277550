// Finds tiles that show nothing, or one colour all over, from the index without drawing: for a tile
// and all tiles below it together, down to the last zoom.
//
// A layer shows nothing in a tile if no feature comes near it, by the distance that outlines, dust
// and marks of small polygons reach. It shows one colour if trapezoids that are drawn the same way
// cover the tile and its surroundings. Both must hold at the tolerance of each zoom: the search
// covers everything that is alive at any of these tolerances, and each zoom is judged by what is
// alive at its own. Undecided tiles are left to be drawn, so a tile may be drawn unnecessarily, but
// never the reverse.
//
// Thread-safety: one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/layer/level_span.h"
#include "server/labels/label_book.h"
#include "server/seed/seed_plan.h"
#include "server/styles/feature_classes.h"

namespace trapeze {

/// Describes what a tile shows: each visible layer and the class that covers it, from the top;
/// empty if there is only the background. Tiles with equal looks have equal bytes, at any zoom.
using TileLook = std::string;

class KnownTiles {
 public:
  /// `plan` must outlive it.
  KnownTiles(const SeedPlan& plan, std::shared_ptr<FeatureClassCache> classes,
             std::shared_ptr<LabelBook> labels);

  /// Examines a tile of a zoom up to the last. The tile must have zoom 0, or be a child of the tile
  /// examined last at the zoom before.
  void look_at(const TileId& tile);

  /// For the tile examined last: the look of the tiles of a zoom at or below it. `zoom` must be one
  /// of those to be seeded. Nothing if it is not known.
  const std::optional<TileLook>& look_at_zoom(int zoom) const {
    return looks_[static_cast<std::size_t>(zoom)];
  }
  /// Whether the look is known for all zooms to be seeded, from the tile's own on.
  bool is_known() const { return is_known_; }

  /// Estimates how many tiles at and below it have to be drawn, from the lengths of boundaries, and
  /// how many trapezoids are drawn into them. Nothing if there are too many trapezoids to estimate.
  struct Estimate {
    double tiles = 0;
    double trapezoids = 0;
  };
  std::optional<Estimate> estimate() const;

 private:
  // A layer, or a part of one, that is drawn at some of the zooms.
  struct Drawn {
    std::size_t layer = 0;
    std::size_t number = 0;  // of the layer among the drawn ones, from the top
    Topology topology = Topology::strict;
    const PreparedPart* part = nullptr;             // null: a layer in one piece
    const Layer* opened = nullptr;                  // null: a part that has not been read yet
    std::shared_ptr<const FeatureClasses> classes;  // null: all features are drawn the same way
    std::vector<const LayerPaint*> paints;          // by zoom; null if it is not drawn there
  };
  // What may be found below a tile; nothing is recorded if it is too much.
  struct Step {
    TileId tile;
    std::vector<LevelSpan> spans;  // by drawn layer
    std::vector<char> is_found;
  };

  void add_drawn(const TilePlan& plan, const LayerPaint& paint);
  bool open(Drawn& drawn, const LayerPaint& paint);
  bool find(Drawn& drawn, const LevelSpanSelection& selection, const TileId& tile, LevelSpan& span);
  LevelSpanSelection selection_of(const Drawn& drawn, const TileId& tile) const;
  int first_zoom(const TileId& tile) const;
  bool may_have_labels(const TileId& tile) const;
  bool may_have_lines_over_the_antimeridian(const TileId& tile);
  void find_looks(const Step& step);
  std::optional<TileLook> find_look(const Step& step, int zoom);
  enum class Seen : std::uint8_t { nothing, one_colour, something };
  Seen find_seen(const Drawn& drawn, const LevelSpan& span, const TileId& tile, int zoom,
                 std::uint8_t& number);

  /// Replaces ranges_ by the polygons of a zoom, and finds their common class; false if they are
  /// not all drawn the same way.
  bool find_alike(const Drawn& drawn, const LevelSpan& span, const Layer& layer,
                  const LayerPaint& paint, std::uint8_t& number);

  const SeedPlan& plan_;
  std::shared_ptr<FeatureClassCache> classes_;
  std::shared_ptr<LabelBook> labels_;
  std::vector<Drawn> drawn_;  // from the top
  std::vector<Step> steps_;   // by zoom
  TileId tile_;
  bool is_known_ = false;
  std::vector<std::optional<TileLook>> looks_;  // by zoom
  LevelSpan across_;                            // kept for its memory
  std::vector<TrapezoidRange> ranges_;          // reused to save allocations
};

}  // namespace trapeze
