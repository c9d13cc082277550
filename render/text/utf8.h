// The characters of a line of text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace trapeze {

/// The first `most` characters of a text in UTF-8; at most four times as many bytes are read.
/// Invalid bytes become U+FFFD each, and so does a character whose end is missing. Tabs and ends of
/// lines and paragraphs become spaces; other control characters are left out.
std::u32string characters_of_line(std::string_view text, std::size_t most);

}  // namespace trapeze
