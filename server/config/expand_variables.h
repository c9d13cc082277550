// Expands ${NAME} in strings of the configuration.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace trapeze {

/// The value of a variable; null if it is not set.
using FindVariable = std::function<const char*(const std::string& name)>;

struct ExpandedText {
  std::string text;
  std::string problem;  // what is wrong, as text; may be empty
};

/// Replaces ${NAME} by the variable, ${NAME:-words} by the words if the variable is not set or
/// empty, and $$ by $. A name consists of letters, digits and '_'. Values are not expanded again.
ExpandedText expand_variables(std::string_view text, const FindVariable& find);

}  // namespace trapeze
