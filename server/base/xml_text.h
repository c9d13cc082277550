// Text escaped for XML documents.
#pragma once

#include <string>
#include <string_view>

namespace trapeze {

/// Safe between tags and in attributes: markup is escaped; invalid UTF-8, and characters that XML
/// 1.0 does not allow, become U+FFFD.
std::string xml_escape(std::string_view text);

}  // namespace trapeze
