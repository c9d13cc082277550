// Trapezoids in the device's format (see render/gl/gl_mesh_store.h).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/grid/grid.h"
#include "render/gl/gl_mesh_store.h"

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

/// The x of the line through two points of different y, at that y; exact at the lower point.
double x_at(Point upper, Point lower, std::int32_t y);

/// Memory is kept between uses.
struct TrapezoidList {
  std::vector<TrapezoidRecord> records;

  std::size_t size() const { return records.size(); }
  void cut(std::size_t count) { records.resize(count); }
  /// Appends the trapezoid unless it has no height or is outside `view`.
  void append(const TrapezoidRecord& trapezoid, const Box& view);
  /// Appends a triangle: its parts above and below the level of the middle vertex.
  void append_triangle(std::array<Point, 3> corners, const Box& view);
};

}  // namespace trapeze::experiment
