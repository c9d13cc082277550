// Reports that a property does not hold.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace trapeze::fuzzing {

/// Ends the program with the message if the condition does not hold.
inline void require(bool condition, std::string_view words) {
  if (condition) return;
  std::fprintf(stderr, "%.*s\n", static_cast<int>(words.size()), words.data());
  std::abort();
}

/// The bytes of an input as text.
inline std::string_view text_of(const unsigned char* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace trapeze::fuzzing
