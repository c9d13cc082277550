// The pieces of a layer where a picture is drawn: the layer itself, or for a layer in several
// parts, those parts that may be visible there, or its overview.
//
// Thread-safety: any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "core/io/prepared/prepared_parts.h"
#include "core/layer/layer.h"
#include "server/tiles/tile_plan.h"

namespace trapeze {

/// Valid as long as the dataset of the plan.
struct LayerPiece {
  const Layer* layer = nullptr;
  std::uint64_t revision = 0;  // tells its features from those of other pieces
};

/// The parts that may be visible in the view, in the order of their numbers, without opening them.
/// The overview alone where all features are drawn the same way and all is coarse enough. The layer
/// of the paint must be in parts.
std::vector<const PreparedPart*> parts_in_view(const TilePlan& plan, const LayerPaint& paint,
                                               const View& view);

/// In painting order. Opens the parts. If a part cannot be opened, throws std::runtime_error that
/// names the file; from then on plan.damaged_layer() reports the layer.
std::vector<LayerPiece> pieces_in_view(const TilePlan& plan, const LayerPaint& paint,
                                       const View& view);

}  // namespace trapeze
