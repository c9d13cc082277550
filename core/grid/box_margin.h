// Boxes with room around them.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/grid/grid.h"

namespace trapeze {

/// The box and so many cells around it, as far as there is a grid.
inline Box with_margin(const Box& box, double margin) {
  const auto cell = [](double v) {
    return static_cast<std::int32_t>(std::clamp<double>(v, kGridMin, kGridMax));
  };
  return {cell(box.min_x - margin), cell(box.min_y - margin), cell(box.max_x + margin),
          cell(box.max_y + margin)};
}

}  // namespace trapeze
