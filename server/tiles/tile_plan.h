// What is to be drawn for one picture, a tile or a window of the map, with names resolved and
// defaults filled in.
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

/// Layers that cannot be seen, being transparent or outside of their zooms, are left out.
struct TilePlan {
  std::shared_ptr<const Dataset> dataset;
  View view;
  double scale = 1;  // of lines and patterns
  Rgba background;
  std::vector<LayerPaint> layers;  // bottom first
  /// Those of the request that are labelled, bottom first: at other zooms, too, so that at all
  /// zooms the same labels have the same places.
  std::vector<LabelledLayer> labels = {};
  DebugMarks debug = {};
  TileFormat format = TileFormat::png;
  Quality quality = Quality::bounded;
  std::string caption = {};  // for debug=tile

  /// What the paint is for, made with or without the topological consistency test as it says. Of a
  /// layer in several parts see pieces_in_view().
  const Layer& layer_of(const LayerPaint& paint) const;
  /// The first of the layers whose prepared file was truncated while it was mapped; null if
  /// there is none. To be called before drawing and after.
  const ServedLayer* damaged_layer() const;
  /// The level of a quarter of a pixel of the picture.
  Level pixel_level() const;
  /// Equal for plans that give the same picture with the same program, however the requests were
  /// written. Holds the revisions of the layers.
  std::string key() const;
};

/// The problem is 404 for a layer that is not in the dataset, 400 for a style that does not fit its
/// layer.
Result<TilePlan> plan_window(const WindowRequest& request, std::shared_ptr<const Dataset> dataset);
/// Whether plan_window() has to find out first what takes time of all features of a layer.
bool has_to_look(const WindowRequest& request, const Dataset& dataset);
/// The same of the window that is a tile.
Result<TilePlan> plan_tile(TileRequest request, std::shared_ptr<const Dataset> dataset);

}  // namespace trapeze
