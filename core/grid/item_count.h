// Limits of 32-bit counts: counts are checked where they grow, so none wraps around.
#pragma once

#include <cstddef>
#include <string>

namespace trapeze {

/// The maximum number of items of one kind in a layer: 0xffffffff means none.
constexpr std::size_t kMostItems = 0xfffffffe;

/// The maximum number of segments of one graph: it has up to three nodes for each.
constexpr std::size_t kMostSegments = std::size_t{1} << 30;

/// "5000000000 vertices, of which there can be 4294967294 at most".
std::string too_many_words(std::size_t count, const char* what, std::size_t most);

/// Throws std::length_error with that message.
[[noreturn]] void throw_too_many(std::size_t count, const char* what, std::size_t most);

/// Throws std::length_error if there are more than `most` of the items.
inline void require_countable(std::size_t count, const char* what, std::size_t most = kMostItems) {
  if (count > most) throw_too_many(count, what, most);
}

}  // namespace trapeze
