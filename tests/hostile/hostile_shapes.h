// Rings in degrees that are hard to build a graph of. Each depends on its arguments only; none
// repeats its first position at the end.
#pragma once

#include <string>
#include <vector>

#include "core/grid/web_mercator.h"

namespace trapeze {

using LonLatRing = std::vector<LonLat>;
/// Shell and holes, in the terms of the source.
using LonLatPolygon = std::vector<LonLatRing>;

/// About the width of a grid cell.
constexpr double kCellDegrees = 360.0 / 2147483648.0;

LonLatRing square(double west, double south, double side);
LonLatRing rectangle(double west, double south, double east, double north);
/// `points` corners alternating between two radii, around (lon, lat).
LonLatRing star(int points, double inner, double outer, LonLat centre = {});
/// The corners of a regular polygon, each joined with the `step`th after it, so that all edges
/// cross.
LonLatRing star_polygon(int points, int step, double radius);
/// Teeth on one back, each `height` high and leaning by `lean` to the east.
LonLatRing comb(int teeth, double pitch, double height, double lean);
LonLatRing with_bow_tie_in_the_middle(LonLatRing ring);
/// Alternating horizontal and vertical edges.
LonLatRing battlements(int merlons, double pitch, double height);
LonLatRing staircase(int steps, double step);
/// An arm that winds around itself; `width` is relative to the distance between turns.
LonLatRing spiral(int turns, int corners_a_turn, double width);
LonLatRing koch_snowflake(int depth, double radius);
/// A ribbon along Hilbert's curve.
LonLatRing hilbert_ribbon(int order, double side, double width);
/// A curve that folds back onto itself, corner upon corner.
LonLatRing dragon_curve(int folds, double step);
LonLatRing lissajous(int points, int a, int b);
/// Triangles that all begin at (0, 0), as one ring.
LonLatRing flower(int petals, double radius);
/// Pairs of triangles that cross, in a row, as one ring.
LonLatRing chain_of_bow_ties(int ties);
/// A needle from (0, 0) in that direction.
LonLatRing sliver(double length, double thickness, double radians);
/// Random positions in a square of that side around (0, 0).
LonLatRing soup(int points, double side, unsigned seed);
/// Random positions on a lattice of so many cells: corners on edges, edges on edges.
LonLatRing lattice_soup(int points, int cells, double step, unsigned seed);
LonLatRing random_walk(int points, double step, unsigned seed);
/// There and back along one line.
LonLatRing there_and_back(int points);
LonLatRing repeated(const LonLatRing& ring, int times_each);
LonLatRing reversed(LonLatRing ring);
LonLatRing moved(LonLatRing ring, double east, double north);
/// Nested squares, each `gap` smaller on every side.
std::vector<LonLatRing> nested_squares(int depth, double gap);
/// The black squares of a board with so many squares a side: they touch at corners.
std::vector<LonLatRing> checkerboard(int squares, double side);
std::vector<LonLatRing> lattice_of_squares(int squares, double pitch, double side);
std::vector<LonLatRing> random_triangles(int count, double size, unsigned seed);
/// The triangles removed from Sierpinski's triangle: each touches its neighbours at corners.
std::vector<LonLatRing> sierpinski_holes(int depth, double side);

}  // namespace trapeze
