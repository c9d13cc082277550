// Which inputs an expensive check is made of, so that all others can be many.
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

/// Whether an input is among one in `parts`.
inline bool is_one_in(std::uint32_t parts, const std::uint8_t* data, std::size_t size) {
  return hash_of(data, size) % parts == 0;
}

}  // namespace trapeze::fuzzing
