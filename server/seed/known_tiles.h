// Which tiles show nothing, or one colour all over, told from the index without drawing: for a tile
// and all tiles below it at once, down to the last zoom.
//
// A layer shows nothing in a tile if nothing comes near it, by as much as outlines, dust and marks
// of small polygons reach. It shows one colour if trapezoids that are drawn alike cover the tile
// and its surroundings. Both must hold at the tolerance of each zoom: what is looked at is whatever
// is alive at any of these, and each zoom is judged by what is alive at its own. What cannot be
// told is left to be drawn, so that tiles may be drawn that need not be, but never the reverse.
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

/// What tiles of one look show: each layer that is seen and the class that covers it, from the top;
/// none if there is only the background. Tiles of equal looks have equal bytes, at any zoom.
using TileLook = std::string;

class KnownTiles {
 public:
  /// `plan` must outlive it.
  KnownTiles(const SeedPlan& plan, std::shared_ptr<FeatureClassCache> classes,
             std::shared_ptr<LabelBook> labels);

  /// Looks at a tile of a zoom up to the last. It is of zoom 0, or a child of the tile of the
  /// zoom before that was looked at last.
  void look_at(const TileId& tile);

  /// Of the tile that was looked at last: what the tiles of a zoom below it show, `zoom` being one
  /// of those to be seeded, and not less than its own. Nothing if that is not known.
  const std::optional<TileLook>& look_at_zoom(int zoom) const {
    return looks_[static_cast<std::size_t>(zoom)];
  }
  /// Whether that is known of all zooms to be seeded from its own on.
  bool is_known() const { return is_known_; }

  /// About how many tiles at and below it have to be drawn, by the lengths of boundaries; nothing
  /// if there are too many trapezoids to tell. In `trapezoids`, how many are put into them.
  struct Estimate {
    double tiles = 0;
    double trapezoids = 0;
  };
  std::optional<Estimate> estimate() const;

 private:
  // A layer as it is drawn at some of the zooms, or a part of one.
  struct Drawn {
    std::size_t layer = 0;
    std::size_t number = 0;  // of the layer among those that are drawn, from the top
    Topology topology = Topology::strict;
    const PreparedPart* part = nullptr;             // null: it is a layer in one piece
    const Layer* opened = nullptr;                  // null: of a part that nobody has looked at
    std::shared_ptr<const FeatureClasses> classes;  // null: all are drawn alike
    std::vector<const LayerPaint*> paints;          // by zoom; null where it is not drawn
  };
  // What may be met below a tile; nothing is known where there is too much of it.
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
  bool may_have_lines_over_the_antimeridian(const TileId& tile) const;
  void find_looks(const Step& step);
  std::optional<TileLook> find_look(const Step& step, int zoom);
  enum class Seen : std::uint8_t { nothing, one_colour, something };
  Seen find_seen(const Drawn& drawn, const LevelSpan& span, const TileId& tile, int zoom,
                 std::uint8_t& number);

  /// Replaces ranges_ by the polygons of a zoom, and finds the class of all of them; false if they
  /// are not drawn alike.
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
  std::vector<TrapezoidRange> ranges_;          // kept for its memory
};

}  // namespace trapeze
