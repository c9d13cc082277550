// What decides of which inputs expensive checks are made, so that all others can be many.
#pragma once

#include <cstddef>
#include <cstdint>

namespace trapeze::fuzzing {

/// A number that an input has in every run, whoever asks; inputs are spread over all numbers.
inline std::uint32_t hash_of(const std::uint8_t* data, std::size_t size) {
  std::uint32_t hash = 2166136261u;
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ data[i]) * 16777619u;
  return hash ^ hash >> 15;
}

/// What is checked of a graph, beside that it can be built: all, after every step, or one of the
/// parts, each of which takes about as long as building.
enum class Checks : std::uint8_t { all, rebuilding, tolerances, history };

/// All of one input in eight, and of the others one part, by the hash of the input.
inline Checks checks_of(std::uint32_t hash) {
  return hash % 8 == 0 ? Checks::all : static_cast<Checks>(1 + hash / 8 % 3);
}

inline bool is_made(Checks checks, Checks part) {
  return checks == Checks::all || checks == part;
}

/// How many tolerances a graph is adapted to.
inline int jumps_of(Checks checks) {
  return checks == Checks::all ? 8 : 2;
}

}  // namespace trapeze::fuzzing
