// Dust: the area of loops too small to draw, kept as covered area, so that a town at a small scale
// is a grey tint and not a hole.
//
// A grain that a loop left behind is laid out as square motes along the axis of its rectangle,
// which is no wider than a pixel at the tolerance at which the loop went. From one octave of
// tolerance to the next, motes that fall into one pixel (four times the tolerance: the default
// tolerance is a quarter of a pixel) become one, so that the motes of a tile are bounded by its
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

/// Motes of a smaller area are left out, in cells squared.
constexpr double kSmallestMote = 0.5;

/// The most motes that a grain is laid out as.
constexpr int kMostMotes = 256;

/// The rectangle that stands for a grain.
struct Strip {
  Axis axis;
  double length = 0;  // cells, at least as much as the width
  double width = 0;

  /// The corners, one after the other, rounded to cells. They may lie off the axis' ends, but not
  /// off the grid.
  std::array<Point, 4> corners() const;
};

/// The rectangle of that area with that axis; a square if the axis is short.
inline Strip strip_of(Axis axis, double area) {
  const double dx = static_cast<double>(axis.to.x) - axis.from.x;
  const double dy = static_cast<double>(axis.to.y) - axis.from.y;
  const double side = std::sqrt(std::abs(area));
  const double length = std::max(std::sqrt(dx * dx + dy * dy), side);
  return {axis, length, length > 0 ? side * (side / length) : 0};
}

/// How many motes a grain is laid out as along its axis: one for each pixel, `pixel` cells long,
/// and at least one, but no more than `most`.
inline int count_of_motes(Axis axis, double pixel, int most) {
  const double dx = static_cast<double>(axis.to.x) - axis.from.x;
  const double dy = static_cast<double>(axis.to.y) - axis.from.y;
  const double pixels = std::ceil(std::sqrt(dx * dx + dy * dy) / pixel);
  // In this order, 1 if that is no number: of a file that is cut off while it is mapped, all may
  // read as zero.
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

/// The most motes for each of the grains of a layer of so many vertices: kMostMotes, unless grains
/// are long and many. Then it is halved until all together have no more than 65,536 motes and four
/// for each vertex, so that a layer of slivers does not take kilobytes for each.
int most_motes_of(const std::vector<Grain>& grains, std::size_t vertices);

/// The motes of all levels, of a layer of so many vertices. The sum of the areas alive at a level
/// is that of the grains born by then, but for motes too small to matter (less than half a cell
/// squared).
std::vector<Mote> settle(const std::vector<Grain>& grains, std::size_t vertices);

}  // namespace trapeze
