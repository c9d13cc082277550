// The pattern of LIKE: % matches anything, _ matches one character, and a backslash escapes the
// next character.
//
// Patterns come from requests and texts may be long, so the time is bounded: linear in the length
// of the text; for a part between two % that contains a _, times the length of the part over 64.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace trapeze {

/// Thread-safety: immutable.
class LikePattern {
 public:
  explicit LikePattern(std::string_view pattern);

  /// Whether the pattern matches the whole text. A character is a byte with its UTF-8 continuation
  /// bytes.
  bool matches(std::string_view text) const;

 private:
  /// The bytes between two %.
  struct Part {
    std::string bytes;
    std::vector<bool> is_any;  // by byte: whether it is a _, which matches a character
    bool has_any = false;
    // For a part in the middle with a _: for each byte value, the positions in the part where it
    // occurs literally, and the positions of _, as bit sets.
    std::vector<std::uint64_t> places_of;
    std::vector<std::uint64_t> any_places;

    std::size_t words() const { return (bytes.size() + 63) / 64; }
  };

  static void note_places(Part& part);
  static bool fits_at_begin(const Part& part, std::string_view& text);
  static bool fits_at_end(const Part& part, std::string_view& text);
  static bool take_first(const Part& part, std::string_view& text);
  static bool take_first_with_any(const Part& part, std::string_view& text);

  std::vector<Part> parts_;  // one more than there are %
};

}  // namespace trapeze
