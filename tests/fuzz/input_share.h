// What decides of which inputs an expensive check is made, so that all others can be many.
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

}  // namespace trapeze::fuzzing
