// The integer grid on which all geometry of the core lies.
//
// Web Mercator (EPSG:3857) is snapped to 2^31 x 2^31 square cells. x grows eastwards, y grows
// southwards (so "above" means "smaller y"), the origin (0, 0) is longitude 0, latitude 0, and both
// coordinates lie in [kGridMin, kGridMax]. A cell is 1.87 cm wide at the equator; 2 cells are one
// pixel of a 256-pixel tile at zoom 22.
//
// All predicates are exact: twice the area of a triangle of grid points is at most 2^62, which fits
// into 64 bits. No predicate has a tolerance.
#pragma once

#include <cstdint>

namespace trapeze {

/// For sums and products that do not fit into 64 bits; an extension of g++ and clang.
__extension__ using Int128 = __int128;

constexpr int kGridBits = 31;
constexpr std::int64_t kGridSize = std::int64_t{1} << kGridBits;  // cells per side of the world
constexpr std::int32_t kGridMin = -(1 << 30);
constexpr std::int32_t kGridMax = 1 << 30;

/// A grid point, in cells.
struct Point {
  std::int32_t x = 0;
  std::int32_t y = 0;

  friend constexpr bool operator==(Point, Point) = default;
};

/// The sweep order: by y, then by x. It acts as a shear that leaves no two distinct points at the
/// same height, so every trapezoid has exactly one vertex on its top and one on its bottom.
constexpr bool is_above(Point a, Point b) {
  return a.y != b.y ? a.y < b.y : a.x < b.x;
}

/// Twice the signed area of the triangle abc, in cells squared: positive if c lies to the right of
/// the directed line ab as seen on the map (y grows downwards), negative to the left, 0 if the
/// three are collinear. Exact for all points of the grid.
constexpr std::int64_t orientation(Point a, Point b, Point c) {
  // The products may reach 2^62 each, and their difference stays within [-2^62, 2^62]. Unsigned
  // arithmetic keeps the intermediate step well defined.
  const auto product = [](std::int64_t p, std::int64_t q) {
    return static_cast<std::uint64_t>(p * q);
  };
  return static_cast<std::int64_t>(product(std::int64_t{b.x} - a.x, std::int64_t{c.y} - a.y) -
                                   product(std::int64_t{b.y} - a.y, std::int64_t{c.x} - a.x));
}

/// A closed axis-parallel rectangle of the grid, in cells; empty if min > max in x or y.
struct Box {
  std::int32_t min_x = kGridMax;
  std::int32_t min_y = kGridMax;
  std::int32_t max_x = kGridMin;
  std::int32_t max_y = kGridMin;

  constexpr bool is_empty() const { return min_x > max_x || min_y > max_y; }
  constexpr void include(Point p) {
    min_x = p.x < min_x ? p.x : min_x;
    min_y = p.y < min_y ? p.y : min_y;
    max_x = p.x > max_x ? p.x : max_x;
    max_y = p.y > max_y ? p.y : max_y;
  }
  constexpr void include(const Box& b) {
    min_x = b.min_x < min_x ? b.min_x : min_x;
    min_y = b.min_y < min_y ? b.min_y : min_y;
    max_x = b.max_x > max_x ? b.max_x : max_x;
    max_y = b.max_y > max_y ? b.max_y : max_y;
  }
  constexpr bool intersects(const Box& b) const {
    return min_x <= b.max_x && b.min_x <= max_x && min_y <= b.max_y && b.min_y <= max_y;
  }

  friend constexpr bool operator==(const Box&, const Box&) = default;
};

}  // namespace trapeze
