// The table of query parameters in docs/styling.md.
#pragma once

#include <string>

namespace trapeze {

/// Markdown, one row for each parameter that requests can set.
std::string parameter_table();

}  // namespace trapeze
