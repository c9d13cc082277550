// What to draw for one picture, a tile or a window of the map, with names resolved and defaults
// filled in.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/graph/topology.h"
#include "core/grid/tolerance.h"
#include "core/layer/layer.h"
#include "render/mask/mask.h"
#include "render/picture/colour.h"
#include "render/picture/reduce_colours.h"
#include "server/base/result.h"
#include "server/data/dataset.h"
#include "server/labels/label_style.h"
#include "server/styles/debug_marks.h"
#include "server/tiles/layer_style.h"
#include "server/tiles/tile_request.h"
#include "server/tiles/window_request.h"

namespace trapeze {

struct LayerPaint {
  std::size_t layer = 0;  // position in the dataset
  LayerStyle style;
  Level level = 0;  // of the ladder of tolerances
  Topology topology = Topology::strict;
  SmallPolygons small = SmallPolygons::dust;

  friend bool operator==(const LayerPaint&, const LayerPaint&) = default;
};

/// Does not contain layers that cannot be seen, being transparent or outside their zoom range.
struct TilePlan {
  std::shared_ptr<const Dataset> dataset;
  View view;
  double scale = 1;  // of lines and patterns
  Rgba background;
  std::vector<LayerPaint> layers;  // bottom first
  /// The labelled layers of the request, bottom first. They include layers outside their zoom
  /// range, so that the same labels have the same places at all zooms.
  std::vector<LabelledLayer> labels = {};
  DebugMarks debug = {};
  TileFormat format = TileFormat::png;
  Quality quality = Quality::bounded;
  std::string caption = {};  // for debug=tile

  /// The layer that the paint is for, built with or without the topological consistency test as the
  /// paint requires. For a layer in several parts, see pieces_in_view().
  const Layer& layer_of(const LayerPaint& paint) const;
  /// The first of the layers whose prepared file was truncated while it was memory-mapped; null if
  /// there is none. Call it before and after drawing.
  const ServedLayer* damaged_layer() const;
  /// The level of a quarter of a pixel of the picture.
  Level pixel_level() const;
  /// Equal for plans that give the same picture with the same program, however the requests were
  /// written. Contains the revisions of the layers.
  std::string key() const;
};

/// The problem is 404 for a layer that is not in the dataset, 400 for a style that does not fit its
/// layer.
Result<TilePlan> plan_window(const WindowRequest& request, std::shared_ptr<const Dataset> dataset);
/// Whether plan_window() first has to compute something from all features of a layer, which takes
/// time.
bool has_to_look(const WindowRequest& request, const Dataset& dataset);
/// The same for the window of a tile.
Result<TilePlan> plan_tile(TileRequest request, std::shared_ptr<const Dataset> dataset);

}  // namespace trapeze
