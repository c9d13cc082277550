// The characters of a line of text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace trapeze {

/// The first `most` characters of a UTF-8 text; reads at most four times as many bytes. Each
/// invalid byte, and each incomplete character, becomes U+FFFD. Tabs and ends of lines and
/// paragraphs become spaces; other control characters are left out.
std::u32string characters_of_line(std::string_view text, std::size_t most);

}  // namespace trapeze
