// Plate carree: the projection in which a degree is a square, as an alternative to Web Mercator. x
// is the same in both, so a cell has the same width. y differs, but independently of x: horizontal
// lines stay horizontal, and trapezoids stay trapezoids, except that their sides become curves.
//
// Distance of such a curve from its chord: let c be cells per radian. Along a side, x is linear in
// the y of the grid. The row of plate carree that corresponds to y is Y(y) = c gd(y / c), where gd
// is the Gudermannian function, whose second derivative is -sin(2 latitude) / 2. Between two points
// of a curve that are d apart in y, linear interpolation of Y is off by at most d^2 / 8 times the
// greatest |Y''| <= 1 / (2 c). So the curve is within d^2 / (16 c) of its chord, upwards or
// downwards, and no farther in any other direction.
//
// Thread-safety: may be called from any thread.
#pragma once

#include <cstdint>

#include "core/grid/grid.h"

namespace trapeze {

/// 90 degrees, in cells of plate carree.
constexpr std::int32_t kQuarterTurn = kGridMax / 2;

/// Converts y from cells of the grid to cells of plate carree, not rounded.
double plate_carree_from_mercator(double y);
/// The same for a cell of the grid, rounded: from a table, in a tenth of the time, within 0.0001
/// cells before rounding.
std::int32_t plate_carree_row(std::int32_t y);
/// The inverse. The poles and places beyond them are far off the grid.
double mercator_from_plate_carree(double y);

/// By how much a degree of latitude exceeds a degree of longitude in cells of the grid, at that y
/// of the grid: the factor 1 / cos(latitude).
double mercator_stretch(double y);

/// The greatest power of two such that sides up to so many cells of the grid high are within `most`
/// cells of their chords in plate carree.
std::int64_t straight_height(double most);

}  // namespace trapeze
