// The Hilbert curve over the grid: sorting by it places points that are near each other on the map
// near each other in memory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/grid/grid.h"

namespace trapeze {

/// The position of a point along a Hilbert curve of order 16. Points with successive positions are
/// neighbours on the map.
inline std::uint32_t hilbert(Point p) {
  std::uint32_t x = (static_cast<std::uint32_t>(p.x) + 0x40000000u) >> 15;
  std::uint32_t y = (static_cast<std::uint32_t>(p.y) + 0x40000000u) >> 15;
  x = std::min(x, 0xffffu);
  y = std::min(y, 0xffffu);
  std::uint32_t d = 0;
  for (std::uint32_t s = 0x8000; s > 0; s /= 2) {
    const std::uint32_t rx = (x & s) != 0;
    const std::uint32_t ry = (y & s) != 0;
    d += s * s * ((3 * rx) ^ ry);
    if (ry == 0) {
      if (rx == 1) {
        x = 0xffffu - x;
        y = 0xffffu - y;
      }
      std::swap(x, y);
    }
  }
  return d;
}

}  // namespace trapeze
