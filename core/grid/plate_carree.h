// Plate carree: the map of the world in which degrees are squares, beside Web Mercator. West and
// east are the same in both, so that a cell is as wide; north and south differ, but not by where on
// a parallel a place is: what is horizontal stays so, and trapezoids stay trapezoids but for their
// sides, which become curves.
//
// How far such a curve is from its chord. Let c be cells per radian. A side has x in proportion to
// the y of the grid; the row of plate carree that belongs to y is Y(y) = c gd(y / c), gd being the
// Gudermannian function, whose second derivative is -sin(2 latitude) / 2. Between two points of a
// curve that are d apart in y, linear interpolation of Y is off by at most d^2 / 8 times the
// greatest |Y''| <= 1 / (2 c): so the curve is within d^2 / (16 c) of its chord, upwards or
// downwards, and no farther in any other direction.
//
// Thread-safety: any thread.
#pragma once

#include <cstdint>

#include "core/grid/grid.h"

namespace trapeze {

/// 90 degrees, in cells of plate carree.
constexpr std::int32_t kQuarterTurn = kGridMax / 2;

/// The y of a place in cells of plate carree, from that in cells of the grid, not rounded.
double plate_carree_from_mercator(double y);
/// The same of a cell of the grid, rounded: from a table, in a tenth of the time, within 0.0001
/// cells before rounding.
std::int32_t plate_carree_row(std::int32_t y);
/// The other way round; of the poles and what lies beyond them, far off the grid.
double mercator_from_plate_carree(double y);

/// How many times as many cells of the grid a degree of latitude has as one of longitude, where the
/// grid has that y: 1 / cos(latitude).
double mercator_stretch(double y);

/// The greatest power of two such that sides which are so many cells of the grid high, or less, are
/// within `most` cells of their chords in plate carree.
std::int64_t straight_height(double most);

}  // namespace trapeze
