// What a layer consists of where a picture is drawn: the layer itself, or of one that is in several
// parts those that may be seen there, or its overview.
//
// Thread-safety: any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "core/io/prepared/prepared_parts.h"
#include "core/layer/layer.h"
#include "server/tiles/tile_plan.h"

namespace trapeze {

/// They live as long as the dataset of the plan.
struct LayerPiece {
  const Layer* layer = nullptr;
  std::uint64_t revision = 0;  // tells its features from those of other pieces
};

/// The parts that may be seen in the view, by their numbers, without opening them: the overview
/// alone where all features are drawn alike and everything is coarse enough. The layer of the paint
/// is in parts.
std::vector<const PreparedPart*> parts_in_view(const TilePlan& plan, const LayerPaint& paint,
                                               const View& view);

/// In the order in which they are painted. Opens the parts; throws std::runtime_error that names
/// the file if one cannot be, and from then on plan.damaged_layer() tells.
std::vector<LayerPiece> pieces_in_view(const TilePlan& plan, const LayerPaint& paint,
                                       const View& view);

}  // namespace trapeze
