// Selects the inputs for expensive checks, so that many more inputs run without them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace trapeze::fuzzing {

/// A number that is the same for an input in every run and for every caller; inputs are spread
/// evenly over all numbers.
inline std::uint32_t hash_of(const std::uint8_t* data, std::size_t size) {
  std::uint32_t hash = 2166136261u;
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ data[i]) * 16777619u;
  return hash ^ hash >> 15;
}

/// The checks of a graph, besides that it can be built: all of them, after every step, or one of
/// the parts, each of which takes about as long as building.
enum class Checks : std::uint8_t { all, rebuilding, tolerances, history };

/// All checks for one input in eight and one part for the others, by the hash of the input.
inline Checks checks_of(std::uint32_t hash) {
  return hash % 8 == 0 ? Checks::all : static_cast<Checks>(1 + hash / 8 % 3);
}

inline bool is_made(Checks checks, Checks part) {
  return checks == Checks::all || checks == part;
}

/// The number of tolerances that a graph is adapted to.
inline int jumps_of(Checks checks) {
  return checks == Checks::all ? 8 : 2;
}

}  // namespace trapeze::fuzzing
