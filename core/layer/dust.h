// Dust: the area of loops too small to draw, kept as covered area, so that a built-up area at a
// small scale is a grey tint and not a hole.
//
// A grain that a loop left behind is laid out as square motes along the axis of its rectangle,
// which is no wider than a pixel at the tolerance at which the loop was removed. From one octave of
// tolerance to the next, motes that fall into one pixel (four times the tolerance: the default
// tolerance is a quarter of a pixel) become one. So the number of motes of a tile is bounded by its
// pixels, however many polygons fall into it. Each mote has a lifespan, like a trapezoid. Motes of
// holes have negative area.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/adapt/history.h"
#include "core/grid/area_moments.h"
#include "core/grid/grid.h"
#include "core/grid/tolerance.h"

namespace trapeze {

struct Mote {
  double x = 0;     // cells
  double y = 0;     // cells
  double area = 0;  // cells squared, may be negative
  Lifespan lifespan;
  bool is_merged = false;  // replaces several motes
};

/// The side of a pixel, in cells, whose default tolerance is that of the level.
double pixel_of_level(Level level);

/// Motes of smaller area are left out, in cells squared.
constexpr double kSmallestMote = 0.5;

/// The maximum number of motes of a grain.
constexpr int kMostMotes = 256;

/// The rectangle that represents a grain.
struct Strip {
  Axis axis;
  double length = 0;  // cells, at least as much as the width
  double width = 0;

  /// The corners in order around the rectangle, rounded to cells. They may lie beyond the ends of
  /// the axis, but not off the grid.
  std::array<Point, 4> corners() const;
};

/// The rectangle with that axis and area; a square if the axis is short.
inline Strip strip_of(Axis axis, double area) {
  const double dx = static_cast<double>(axis.to.x) - axis.from.x;
  const double dy = static_cast<double>(axis.to.y) - axis.from.y;
  const double side = std::sqrt(std::abs(area));
  const double length = std::max(std::sqrt(dx * dx + dy * dy), side);
  return {axis, length, length > 0 ? side * (side / length) : 0};
}

/// The number of motes of a grain along its axis: one for each pixel, `pixel` cells long, at least
/// one and at most `most`.
inline int count_of_motes(Axis axis, double pixel, int most) {
  const double dx = static_cast<double>(axis.to.x) - axis.from.x;
  const double dy = static_cast<double>(axis.to.y) - axis.from.y;
  const double pixels = std::ceil(std::sqrt(dx * dx + dy * dy) / pixel);
  // This order of min and max yields 1 for NaN: in a file that is truncated while it is mapped,
  // everything may read as zero.
  return static_cast<int>(std::max(1.0, std::min(pixels, static_cast<double>(most))));
}

/// Calls visit(x, y, area) for `count` motes of a grain of that area, distributed evenly along its
/// axis.
template <typename Visit>
void lay_out(Axis axis, double area, int count, const Visit& visit) {
  const double dx = static_cast<double>(axis.to.x) - axis.from.x;
  const double dy = static_cast<double>(axis.to.y) - axis.from.y;
  for (int i = 0; i < count; ++i) {
    const double along = (i + 0.5) / count;
    visit(axis.from.x + along * dx, axis.from.y + along * dy, area / count);
  }
}

/// The square of a mote, rounded to whole cells. `area` is positive.
Box box_of_mote(double x, double y, double area);

/// The maximum number of motes per grain of a layer of so many vertices. It is kMostMotes unless
/// grains are long and numerous; then it is halved until all grains together have no more than
/// 65,536 motes plus four per vertex, so that a layer of slivers does not take kilobytes for each.
int most_motes_of(const std::vector<Grain>& grains, std::size_t vertices);

/// The motes of all levels, for a layer of so many vertices. The areas alive at a level add up to
/// the area of the grains born by then, except for motes too small to matter (less than half a cell
/// squared).
std::vector<Mote> settle(const std::vector<Grain>& grains, std::size_t vertices);

}  // namespace trapeze
