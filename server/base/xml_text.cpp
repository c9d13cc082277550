#include "server/base/xml_text.h"

#include <cstddef>
#include <cstdint>

namespace trapeze {
namespace {

constexpr std::string_view kReplacement = "\xef\xbf\xbd";

/// The length in bytes of the character at the beginning of `text`, 0 if it is invalid.
std::size_t character_length(std::string_view text) {
  const auto byte = [&text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return 1;
  const std::size_t length = byte(0) < 0xe0 ? 2 : byte(0) < 0xf0 ? 3 : 4;
  if (byte(0) < 0xc2 || byte(0) > 0xf4 || length > text.size()) return 0;
  std::uint32_t code = byte(0) & (0x7fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3fu);
  }
  const bool is_overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool is_surrogate = code >= 0xd800 && code < 0xe000;
  const bool is_no_character = code == 0xfffe || code == 0xffff || code > 0x10ffff;
  return is_overlong || is_surrogate || is_no_character ? 0 : length;
}

}  // namespace

std::string xml_escape(std::string_view text) {
  std::string escaped;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const char c = text.front();
    if (length > 1) {
      escaped += text.substr(0, length);
    } else if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '>') {
      escaped += "&gt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else if (c == '\'') {
      escaped += "&#39;";
    } else if (length == 1 && (c >= 0x20 || c == '\t' || c == '\n' || c == '\r')) {
      escaped += c;
    } else {
      escaped += kReplacement;
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return escaped;
}

}  // namespace trapeze
