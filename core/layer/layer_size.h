// Figures about a layer, for reports.
#pragma once

#include <cstddef>

namespace trapeze {

struct LayerSize {
  std::size_t vertices = 0;    // at full detail
  std::size_t trapezoids = 0;  // versions
  std::size_t edges = 0;       // versions
  std::size_t motes = 0;       // of dust, counted separately
};

}  // namespace trapeze
