// The ladder of tolerances for which lifespans are kept (bounded memory, exact answers).
//
// A tolerance (the paper's epsilon) is a distance in grid cells. Level 0 is the untouched polygon;
// level k >= 1 is the tolerance 2^((k - 1) / 2 + kFirstExponent), two levels to a factor of two. So
// any tolerance is at most a quarter of such a step from a level, and those of whole zooms are on
// it. A mesh "at a level" is the mesh adapted to exactly that tolerance.
#pragma once

#include <cstdint>

namespace trapeze {

using Level = std::uint8_t;

constexpr int kFirstExponent = -1;  // level 1 is half a cell: a quarter of a pixel at zoom 22
constexpr int kLevelsPerOctave = 2;
constexpr Level kLastLevel = 62;   // 2^29.5 cells: nothing but the coarsest shapes is left
constexpr Level kNeverDies = 255;  // the end of a lifespan that reaches beyond the last level

/// The tolerance of a level, in cells; 0 for level 0.
double epsilon_of_level(Level level);

/// The level nearest to `epsilon` (cells, >= 0) in steps: its tolerance is between 2^-1/4 and 2^1/4
/// times `epsilon`. 0 below that of level 1, kLastLevel above that of the last.
Level nearest_level(double epsilon);

/// The first level whose tolerance exceeds `epsilon`, kLastLevel + 1 if there is none: there, a
/// vertex of weight `epsilon` has gone.
int level_above(double epsilon);

/// When a version of a trapezoid or of an edge is part of the mesh: at the levels born <= l < dies.
struct Lifespan {
  Level born = 0;
  Level dies = kNeverDies;

  constexpr bool contains(Level level) const { return born <= level && level < dies; }
  friend constexpr bool operator==(Lifespan, Lifespan) = default;
};

}  // namespace trapeze
