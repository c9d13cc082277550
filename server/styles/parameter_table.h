// The table of query parameters as docs/styling.md has it.
#pragma once

#include <string>

namespace trapeze {

/// Markdown, one row for each parameter that requests can set.
std::string parameter_table();

}  // namespace trapeze
