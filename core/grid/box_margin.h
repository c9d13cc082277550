// Boxes with a margin.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/grid/grid.h"

namespace trapeze {

/// The box extended by so many cells on each side, clipped to the grid.
inline Box with_margin(const Box& box, double margin) {
  const auto cell = [](double v) {
    return static_cast<std::int32_t>(std::clamp<double>(v, kGridMin, kGridMax));
  };
  return {cell(box.min_x - margin), cell(box.min_y - margin), cell(box.max_x + margin),
          cell(box.max_y + margin)};
}

}  // namespace trapeze
