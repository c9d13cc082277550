// The pattern of LIKE: % stands for anything, _ for any one character, and a backslash takes its
// meaning from what follows it.
//
// Patterns come from requests and texts may be long, so the time is bounded: linear in the length
// of the text, times the length of a part between two % over 64 where that has a _.
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

  /// Whether the whole text fits. A character is a byte with the bytes that continue it in UTF-8.
  bool matches(std::string_view text) const;

 private:
  /// What stands between two %.
  struct Part {
    std::string bytes;
    std::vector<bool> is_any;  // by byte: it is a _, which stands for a character
    bool has_any = false;
    // Of a part in the middle that has a _: by byte of a text the places in the part where it may
    // stand as itself, and the places of _, as sets of bits.
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
