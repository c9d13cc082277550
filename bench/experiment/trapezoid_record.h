// A trapezoid as the device keeps it (see render/gl_mesh_store.h), and rings of many polygons.
#pragma once

#include <cstdint>
#include <vector>

#include "core/grid.h"
#include "core/rings.h"
#include "render/gl_mesh_store.h"

namespace trapeze::experiment {

struct TrapezoidRecord {
  std::int32_t top = 0;
  std::int32_t bottom = 0;
  Point left_upper;
  Point left_lower;
  Point right_upper;
  Point right_lower;

  friend bool operator==(const TrapezoidRecord&, const TrapezoidRecord&) = default;
};
static_assert(sizeof(TrapezoidRecord) == GlMeshStore::kTexelsPerTrapezoid * sizeof(Point));

/// Polygons as they are after simplification, one after another, those that have gone left out.
struct SimplifiedPolygons {
  Rings rings;
  std::vector<std::uint32_t> ends;    // polygon i is rings ends[i - 1] .. ends[i] - 1
  std::vector<std::uint32_t> source;  // by polygon: its number in the PolygonSet

  void clear() {
    rings.clear();
    ends.clear();
    source.clear();
  }
  std::size_t size() const { return ends.size(); }
  std::uint32_t first_ring(std::size_t polygon) const {
    return polygon == 0 ? 0 : ends[polygon - 1];
  }
};

}  // namespace trapeze::experiment
