// The characters of a line of text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace trapeze {

/// The first characters of a text in UTF-8, `most` at most, after at most four times as many bytes.
/// What is no UTF-8 becomes U+FFFD: one for each byte, or for each beginning of a character whose
/// end is missing. Tabs and ends of lines and paragraphs become spaces; other control characters
/// are left out.
std::u32string characters_of_line(std::string_view text, std::size_t most);

}  // namespace trapeze
