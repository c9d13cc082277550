// Polygons of a feature on their way to what a style shows of them: with round corners, or grown.
#pragma once

#include <cstdint>

#include "core/borders/polygons.h"

namespace trapeze {

struct DrawnPolygons {
  /// Those of the same number are of one graph: they have vertices and edges in common. Vertices of
  /// several graphs are several, also where they are in the same place.
  std::uint32_t graph = 0;
  bool lies_over_others = false;  // or under them: it stays as it is
  Polygons polygons;
};

}  // namespace trapeze
