#include "core/io/source/source_name.h"

#include <algorithm>
#include <string_view>

namespace trapeze {
namespace {

constexpr std::string_view kMask = "***";
constexpr std::string_view kSpaces = " \t\n\v\f\r";
constexpr std::string_view kSpacesOrNext = " \t\n\v\f\r&";
constexpr std::string_view kLettersOfNames = "abcdefghijklmnopqrstuvwxyz0123456789_-";
constexpr std::string_view kEndsOfQueryValue = "&#";
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

/// Whether the name that contains the character at `at` is that of a parameter in the query of a
/// URL.
bool is_in_query(std::string_view text, std::size_t at) {
  const std::size_t before = text.find_last_not_of(kLettersOfNames, at);
  return before != std::string_view::npos && (text[before] == '?' || text[before] == '&');
}

/// An unclosed quote or brace extends to the end. In a connection string, whose values end only
/// with spaces, a backslash makes the next character a part of the value.
std::size_t end_of_value(std::string_view text, std::size_t begin, std::string_view ends) {
  if (ends == kEndOfOdbc && text[begin] == '{') {
    return std::min(text.find('}', begin), text.size() - 1) + 1;
  }
  const bool is_quoted = text[begin] == '\'';
  const bool has_escapes = is_quoted || ends == kSpaces;
  for (std::size_t i = is_quoted ? begin + 1 : begin; i < text.size(); ++i) {
    if (has_escapes && text[i] == '\\') {
      ++i;
    } else if (is_quoted && text[i] == '\'') {
      return i + 1;
    } else if (!is_quoted && ends.find(text[i]) != std::string_view::npos) {
      return i;
    }
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
    const bool ends_with_next = ends == kSpaces && is_in_query(lower, at - 1);
    const std::size_t end = begin == text.size()
                                ? begin
                                : end_of_value(text, begin, ends_with_next ? kSpacesOrNext : ends);
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

/// For keys in the query of a URL, whatever comes before these words in their names, as in
/// `access_token` and `X-Amz-Signature`.
std::string without_keys_in_query(const std::string& text) {
  const std::size_t query = text.find('?');
  if (query == std::string::npos) return text;
  std::string masked = text.substr(query);
  for (const std::string_view word : {"token", "key", "sig", "signature", "secret"}) {
    masked = without_assigned_passwords(masked, word, kEndsOfQueryValue);
  }
  return text.substr(0, query) + masked;
}

/// For `ODBC:user/password@source,table` and the same of Oracle.
std::string without_login_password(const std::string& text) {
  const std::string lower = lower_case(text);
  if (!lower.starts_with("odbc:") && !lower.starts_with("oci:")) return text;
  const std::size_t slash = text.find('/');
  const std::size_t host = text.substr(0, text.find(',')).rfind('@');
  if (slash == std::string::npos || host == std::string::npos || host < slash) return text;
  return text.substr(0, slash + 1) + std::string(kMask) + text.substr(host);
}

}  // namespace

std::string name_of_source(const std::string& path) {
  const std::string login = without_login_password(path);
  const std::string masked = without_assigned_passwords(login, "password", kSpaces);
  return without_keys_in_query(
      without_user_passwords(without_assigned_passwords(masked, "pwd", kEndOfOdbc)));
}

}  // namespace trapeze
