// The steps of painting a tile, with the names under which they are measured and reported.
#pragma once

#include <array>

#include "server/tiles/painted_tile.h"

namespace trapeze {

struct PaintStage {
  const char* name;
  double PaintTimes::*milliseconds;
};

/// In the order in which a tile passes through them.
inline constexpr std::array kPaintStages = {
    PaintStage{"queue", &PaintTimes::queue_ms},     PaintStage{"select", &PaintTimes::select_ms},
    PaintStage{"draw", &PaintTimes::draw_ms},       PaintStage{"read", &PaintTimes::read_ms},
    PaintStage{"resolve", &PaintTimes::resolve_ms}, PaintStage{"compose", &PaintTimes::compose_ms},
    PaintStage{"encode", &PaintTimes::encode_ms}};

}  // namespace trapeze
