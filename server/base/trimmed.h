// Text without the blanks around it, and text that is cut.
#pragma once

#include <cstddef>
#include <string_view>

namespace trapeze {

/// Without spaces and tabs at either end, the optional whitespace around values in HTTP.
constexpr std::string_view trimmed(std::string_view text, std::string_view blanks = " \t") {
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

/// The first characters of UTF-8 text, as many as take up at most that many bytes.
constexpr std::string_view cut_to_bytes(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text;
  const auto is_inside = [](char byte) {
    return (static_cast<unsigned char>(byte) & 0xc0) == 0x80;
  };
  while (most > 0 && is_inside(text[most])) --most;
  return text.substr(0, most);
}

}  // namespace trapeze
