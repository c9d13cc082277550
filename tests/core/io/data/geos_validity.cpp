#include "tests/core/io/data/geos_validity.h"

#include <vector>

namespace trapeze::testing {

GeosValidity::GeosValidity() : handle_(GEOS_init_r()) {}

GeosValidity::~GeosValidity() {
  GEOS_finish_r(handle_);
}

std::string GeosValidity::complaint(const Rings& rings, std::size_t begin, std::size_t end) const {
  std::vector<GEOSGeometry*> holes;
  GEOSGeometry* shell = ring(rings[begin]);
  for (std::size_t r = begin + 1; r < end; ++r) holes.push_back(ring(rings[r]));
  GEOSGeometry* polygon =
      GEOSGeom_createPolygon_r(handle_, shell, holes.data(), static_cast<unsigned>(holes.size()));
  std::string words;
  if (GEOSisValid_r(handle_, polygon) != 1) {
    char* reason = GEOSisValidReason_r(handle_, polygon);
    words = reason;
    GEOSFree_r(handle_, reason);
  }
  GEOSGeom_destroy_r(handle_, polygon);
  return words;
}

// Cells are whole numbers below 2^31: doubles hold them exactly.
GEOSGeometry* GeosValidity::ring(std::span<const Point> points) const {
  std::vector<double> xy;
  for (std::size_t i = 0; i <= points.size(); ++i) {
    const Point p = points[i % points.size()];
    xy.insert(xy.end(), {static_cast<double>(p.x), static_cast<double>(p.y)});
  }
  return GEOSGeom_createLinearRing_r(
      handle_, GEOSCoordSeq_copyFromBuffer_r(
                   handle_, xy.data(), static_cast<unsigned>(points.size() + 1), false, false));
}

}  // namespace trapeze::testing
