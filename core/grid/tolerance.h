// The levels: the tolerances for which the history of a graph is kept. There are few of them, which
// bounds memory, and the mesh is exact at each of them.
//
// A tolerance (the paper's epsilon) is a distance in grid cells. Level 0 is the polygon at full
// detail; level k >= 1 is the tolerance 2^((k - 1) / 2 + kFirstExponent), so there are two levels
// per octave (a factor of two). Any tolerance is therefore within a factor of 2^1/4 of that of a
// level, and the tolerances of whole zooms are levels themselves. A mesh "at a level" is the mesh
// adapted to exactly that tolerance.
#pragma once

#include <cstdint>

namespace trapeze {

using Level = std::uint8_t;

constexpr int kFirstExponent = -1;  // level 1 is half a cell: a quarter of a pixel at zoom 22
constexpr int kLevelsPerOctave = 2;
constexpr Level kLastLevel = 62;   // 2^29.5 cells: only the coarsest shapes are left
constexpr Level kNeverDies = 255;  // the end of a lifespan that extends beyond the last level

/// The tolerance of a level, in cells; 0 for level 0.
double epsilon_of_level(Level level);

/// The level nearest to `epsilon` (cells, >= 0) on a logarithmic scale: its tolerance is between
/// 2^-1/4 and 2^1/4 times `epsilon`, up to about a thousandth. Tolerances in the middle between two
/// levels, except for the rounding of windows, all get the coarser one. Level 0 if `epsilon` is
/// less than that, kLastLevel if it is more.
Level nearest_level(double epsilon);

/// The first level whose tolerance exceeds `epsilon`, kLastLevel + 1 if there is none: the
/// first level at which a vertex of weight `epsilon` has been removed.
int level_above(double epsilon);

/// The levels at which a version of a trapezoid or of an edge is part of the mesh: born <= l <
/// dies.
struct Lifespan {
  Level born = 0;
  Level dies = kNeverDies;

  constexpr bool contains(Level level) const { return born <= level && level < dies; }
  friend constexpr bool operator==(Lifespan, Lifespan) = default;
};

}  // namespace trapeze
