#include "render/text/utf8.h"

namespace trapeze {
namespace {

constexpr char32_t kReplacement = 0xfffd;

/// How a character begins: its length, and the valid range of its second byte, which excludes
/// overlong forms, surrogates and code points beyond U+10FFFF (Unicode, table 3-7).
struct Lead {
  std::size_t length = 0;  // in bytes; 0: not a valid first byte
  unsigned char least = 0x80;
  unsigned char most = 0xbf;
};

Lead lead_of(unsigned char byte) {
  if (byte < 0x80) return {1};
  if (byte < 0xc2) return {};
  if (byte < 0xe0) return {2};
  if (byte < 0xf0) {
    return {3, static_cast<unsigned char>(byte == 0xe0 ? 0xa0 : 0x80),
            static_cast<unsigned char>(byte == 0xed ? 0x9f : 0xbf)};
  }
  if (byte < 0xf5) {
    return {4, static_cast<unsigned char>(byte == 0xf0 ? 0x90 : 0x80),
            static_cast<unsigned char>(byte == 0xf4 ? 0x8f : 0xbf)};
  }
  return {};
}

/// Removes the first character from `text`, which must not be empty.
char32_t take_character(std::string_view& text) {
  const auto byte_at = [&text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const Lead lead = lead_of(byte_at(0));
  char32_t character = lead.length == 1 ? byte_at(0) : byte_at(0) & (0x7fu >> lead.length);
  std::size_t taken = 1;
  for (; taken < lead.length && taken < text.size(); ++taken) {
    const unsigned char byte = byte_at(taken);
    const bool is_second = taken == 1;
    if (byte < (is_second ? lead.least : 0x80) || byte > (is_second ? lead.most : 0xbf)) break;
    character = character << 6 | (byte & 0x3fu);
  }
  text.remove_prefix(taken);
  return taken == lead.length ? character : kReplacement;
}

bool is_space(char32_t c) {
  return (c >= '\t' && c <= '\r') || c == 0x85 || c == 0x2028 || c == 0x2029;
}

bool is_control(char32_t c) {
  return c < 0x20 || (c >= 0x7f && c < 0xa0);
}

}  // namespace

std::u32string characters_of_line(std::string_view text, std::size_t most) {
  text = text.substr(0, 4 * most);
  std::u32string characters;
  while (!text.empty() && characters.size() < most) {
    const char32_t character = take_character(text);
    if (is_space(character)) {
      characters.push_back(' ');
    } else if (!is_control(character)) {
      characters.push_back(character);
    }
  }
  return characters;
}

}  // namespace trapeze
