#include "core/io/source/source_name.h"

#include <algorithm>
#include <string_view>

namespace trapeze {
namespace {

constexpr std::string_view kMask = "***";
constexpr std::string_view kSpaces = " \t\n\v\f\r";
constexpr std::string_view kEndsOfValue = " \t\n\v\f\r&";
constexpr std::string_view kEndOfOdbc = ";";

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return lower;
}

/// Where the value of an assignment begins whose name ends at `at`; the end of the text if it is no
/// assignment.
std::size_t begin_of_value(std::string_view text, std::size_t at) {
  const std::size_t sign = std::min(text.find_first_not_of(kSpaces, at), text.size());
  if (sign == text.size() || text[sign] != '=') return text.size();
  return std::min(text.find_first_not_of(kSpaces, sign + 1), text.size());
}

/// An unclosed quote or brace extends to the end.
std::size_t end_of_value(std::string_view text, std::size_t begin, std::string_view ends) {
  if (ends == kEndOfOdbc && text[begin] == '{') {
    return std::min(text.find('}', begin), text.size() - 1) + 1;
  }
  if (text[begin] != '\'') return std::min(text.find_first_of(ends, begin), text.size());
  for (std::size_t i = begin + 1; i < text.size(); ++i) {
    if (text[i] == '\'') return i + 1;
    if (text[i] == '\\') ++i;
  }
  return text.size();
}

/// For a connection string, or the query of a URL, in which passwords are called `word`.
std::string without_assigned_passwords(std::string_view text, std::string_view word,
                                       std::string_view ends) {
  const std::string lower = lower_case(text);
  std::string masked;
  std::size_t done = 0;
  for (std::size_t at = 0; (at = lower.find(word, at)) != std::string::npos;) {
    at += word.size();
    const std::size_t begin = begin_of_value(text, at);
    const std::size_t end = begin == text.size() ? begin : end_of_value(text, begin, ends);
    if (begin == end) continue;
    masked.append(text.substr(done, begin - done)).append(kMask);
    at = done = end;
  }
  return masked.append(text.substr(done));
}

/// For URLs: between a user and a host.
std::string without_user_passwords(std::string_view text) {
  std::string masked;
  std::size_t done = 0;
  for (std::size_t at = 0; (at = text.find("://", at)) != std::string_view::npos;) {
    at += 3;
    const std::string_view authority =
        text.substr(at, std::min(text.find('/', at), text.size()) - at);
    const std::size_t host = authority.rfind('@');
    const std::size_t colon = authority.find_first_of(":@");
    if (host == std::string_view::npos || colon == host || authority[colon] == '@') continue;
    masked.append(text.substr(done, at + colon + 1 - done)).append(kMask);
    at = done = at + host;
  }
  return masked.append(text.substr(done));
}

}  // namespace

std::string name_of_source(const std::string& path) {
  const std::string masked = without_assigned_passwords(path, "password", kEndsOfValue);
  return without_user_passwords(without_assigned_passwords(masked, "pwd", kEndOfOdbc));
}

}  // namespace trapeze
