#include "server/config/expand_variables.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace trapeze {
namespace {

constexpr std::string_view kDefaultMark = ":-";

bool is_variable_name(std::string_view name) {
  return !name.empty() && std::ranges::all_of(name, [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

/// Expands the text between the braces.
ExpandedText look_up(std::string_view inside, const FindVariable& find) {
  const std::size_t mark = inside.find(kDefaultMark);
  const std::string name(inside.substr(0, mark));
  if (!is_variable_name(name)) {
    return {"", fmt::format("\"${{{}}}\" names no variable; write $$ for a $", inside)};
  }
  const char* value = find(name);
  if (mark != std::string_view::npos && (value == nullptr || *value == '\0')) {
    return {std::string(inside.substr(mark + kDefaultMark.size())), ""};
  }
  if (value == nullptr) {
    return {"",
            fmt::format("the variable {} is not set; ${{{}:-words}} has a default", name, name)};
  }
  return {value, ""};
}

}  // namespace

ExpandedText expand_variables(std::string_view text, const FindVariable& find) {
  ExpandedText expanded;
  while (!text.empty()) {
    const std::size_t dollar = std::min(text.find('$'), text.size());
    expanded.text += text.substr(0, dollar);
    text.remove_prefix(dollar);
    if (text.starts_with("$$")) {
      expanded.text += '$';
      text.remove_prefix(2);
    } else if (text.starts_with("${")) {
      const std::size_t close = text.find('}');
      if (close == std::string_view::npos) return {"", R"(a "${" has no "}"; write $$ for a $)"};
      auto value = look_up(text.substr(2, close - 2), find);
      if (!value.problem.empty()) return value;
      expanded.text += value.text;
      text.remove_prefix(close + 1);
    } else if (!text.empty()) {
      expanded.text += '$';  // a single $ represents itself
      text.remove_prefix(1);
    }
  }
  return expanded;
}

}  // namespace trapeze
