// Language tags, such as de or zh-Hans (BCP 47).
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace trapeze {

/// Whether the text has the form of a tag: 2 or 3 letters, followed by subtags of 1 to 8 letters or
/// digits, each after a '-', and at most 35 bytes. Does not check whether the language exists.
constexpr bool is_language_tag(std::string_view text) {
  constexpr std::size_t kMostBytes = 35;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (text.size() > kMostBytes) return false;
  std::size_t subtags = 0;
  while (true) {
    const std::size_t end = std::min(text.find('-'), text.size());
    const std::string_view subtag = text.substr(0, end);
    const bool is_first = subtags++ == 0;
    const std::size_t least = is_first ? 2 : 1;
    const std::size_t most = is_first ? 3 : 8;
    if (subtag.size() < least || subtag.size() > most) return false;
    if (!std::all_of(subtag.begin(), subtag.end(),
                     [&](char c) { return is_letter(c) || (!is_first && is_digit(c)); })) {
      return false;
    }
    if (end == text.size()) return true;
    text.remove_prefix(end + 1);
  }
}

}  // namespace trapeze
