// Limits of numbers in 32 bits: what they count is checked where it grows, so that none wraps
// around.
#pragma once

#include <cstddef>
#include <string>

namespace trapeze {

/// The most items of one kind that a layer holds: 0xffffffff stands for none.
constexpr std::size_t kMostItems = 0xfffffffe;

/// The most segments that one graph is built of: it has up to three nodes for each.
constexpr std::size_t kMostSegments = std::size_t{1} << 30;

/// "5000000000 vertices, of which there can be 4294967294 at most".
std::string too_many_words(std::size_t count, const char* what, std::size_t most);

/// Throws std::length_error, in these words.
[[noreturn]] void throw_too_many(std::size_t count, const char* what, std::size_t most);

/// Throws std::length_error if there are more than `most` of the items.
inline void require_countable(std::size_t count, const char* what, std::size_t most = kMostItems) {
  if (count > most) throw_too_many(count, what, most);
}

}  // namespace trapeze
