// Polygons of a feature, to be given the rounded corners or growth with which a style draws them.
#pragma once

#include <cstdint>

#include "core/borders/polygons.h"

namespace trapeze {

struct DrawnPolygons {
  /// Polygons with the same number are of one graph: they share vertices and edges. Vertices of
  /// different graphs are distinct even at the same place.
  std::uint32_t graph = 0;
  bool lies_over_others = false;  // or lies under them: it stays unchanged
  Polygons polygons;
};

}  // namespace trapeze
