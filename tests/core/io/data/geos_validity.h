// What GEOS, an independent library, reports about our polygons.
#pragma once

#include <geos_c.h>

#include <cstddef>
#include <span>
#include <string>

#include "core/grid/grid.h"
#include "core/grid/rings.h"

namespace trapeze::testing {

/// Access to GEOS for one thread.
class GeosValidity {
 public:
  GeosValidity();
  ~GeosValidity();
  GeosValidity(const GeosValidity&) = delete;
  GeosValidity& operator=(const GeosValidity&) = delete;

  /// Returns an empty text if the polygon with the shell rings[begin] and the holes up to `end` is
  /// valid, otherwise the reason. GEOS compares every hole with every other: minutes for ten
  /// thousands.
  std::string complaint(const Rings& rings, std::size_t begin, std::size_t end) const;

 private:
  GEOSGeometry* ring(std::span<const Point> points) const;

  GEOSContextHandle_t handle_;
};

}  // namespace trapeze::testing
