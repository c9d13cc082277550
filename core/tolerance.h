// The ladder of tolerances for which lifespans are kept (bounded memory, exact answers).
//
// A tolerance (the paper's epsilon) is a distance in grid cells. Level 0 is the untouched polygon;
// level k >= 1 is the tolerance 2^((k - 1) / 4 + kFirstExponent), four levels to a factor of two.
// A mesh "at a level" is the mesh adapted to exactly that tolerance.
#pragma once

#include <cstdint>

namespace trapeze {

using Level = std::uint8_t;

constexpr int kFirstExponent = -2;  // level 1 is a quarter of a cell
constexpr int kLevelsPerOctave = 4;
constexpr Level kLastLevel = 128;  // 2^29.75 cells: nothing but the coarsest shapes is left
constexpr Level kNeverDies = 255;  // the end of a lifespan that reaches beyond the last level

/// The tolerance of a level, in cells; 0 for level 0.
double epsilon_of_level(Level level);

/// The highest level whose tolerance does not exceed `epsilon` (cells, >= 0): what is drawn is
/// never coarser than what was asked for, and at most a quarter of an octave finer.
Level level_of_epsilon(double epsilon);

/// When a version of a trapezoid or of an edge is part of the mesh: at the levels born <= l < dies.
struct Lifespan {
  Level born = 0;
  Level dies = kNeverDies;

  constexpr bool contains(Level level) const { return born <= level && level < dies; }
  friend constexpr bool operator==(Lifespan, Lifespan) = default;
};

}  // namespace trapeze
