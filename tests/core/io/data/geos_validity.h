// What GEOS, which is not ours, says of polygons of ours.
#pragma once

#include <geos_c.h>

#include <cstddef>
#include <span>
#include <string>

#include "core/grid/grid.h"
#include "core/grid/rings.h"

namespace trapeze::testing {

/// One thread's use of GEOS.
class GeosValidity {
 public:
  GeosValidity();
  ~GeosValidity();
  GeosValidity(const GeosValidity&) = delete;
  GeosValidity& operator=(const GeosValidity&) = delete;

  /// Empty if the polygon is valid whose shell is rings[begin] and whose holes are those up to
  /// `end`, otherwise why not. Every hole is looked at with every other: minutes for ten thousands.
  std::string complaint(const Rings& rings, std::size_t begin, std::size_t end) const;

 private:
  GEOSGeometry* ring(std::span<const Point> points) const;

  GEOSContextHandle_t handle_;
};

}  // namespace trapeze::testing
