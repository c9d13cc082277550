#include "server/base/url.h"

#include <algorithm>

namespace trapeze {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_alphanumeric(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

/// Calls `take` for each piece of `text` between separators, until it returns false.
template <typename Take>
bool for_each_piece(std::string_view text, char separator, Take take) {
  while (true) {
    const std::size_t end = text.find(separator);
    if (!take(text.substr(0, end))) return false;
    if (end == std::string_view::npos) return true;
    text.remove_prefix(end + 1);
  }
}

bool is_valid_port(std::string_view port) {
  return !port.empty() && port.size() <= 5 && std::ranges::all_of(port, is_digit);
}

std::string to_lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  }
  return lower;
}

/// The position of the port including its colon, or the end of the host.
std::size_t end_of_host_name(std::string_view host) {
  const std::size_t bracket = host.find(']');  // of an IPv6 address, which contains colons
  return std::min(host.find(':', bracket == std::string_view::npos ? 0 : bracket), host.size());
}

}  // namespace

std::optional<Target> split_target(std::string_view target) {
  constexpr std::string_view kScheme = "http://";
  std::string_view host;
  if (to_lower(target.substr(0, kScheme.size())) == kScheme) {
    target.remove_prefix(kScheme.size());
    host = target.substr(0, target.find_first_of("/?"));
    target.remove_prefix(host.size());
  }
  const std::size_t mark = std::min(target.find('?'), target.size());
  std::string_view path = target.substr(0, mark);
  if (path.empty() && !host.empty()) path = "/";
  if (!path.starts_with('/')) return std::nullopt;
  return Target{path, target.substr(std::min(mark + 1, target.size())), host};
}

std::optional<std::string> percent_decode(std::string_view text, Plus plus) {
  std::string decoded;
  decoded.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '+' && plus == Plus::space) {
      c = ' ';
    } else if (c == '%') {
      if (i + 2 >= text.size()) return std::nullopt;
      const int high = hex_digit(text[i + 1]);
      const int low = hex_digit(text[i + 2]);
      if (high < 0 || low < 0) return std::nullopt;
      c = static_cast<char>(high * 16 + low);
      i += 2;
    }
    if (is_control(c)) return std::nullopt;
    decoded.push_back(c);
  }
  return decoded;
}

bool has_control_character(std::string_view text) {
  return std::ranges::any_of(text, is_control);
}

std::string percent_encode(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : text) {
    if (is_alphanumeric(c) || c == '-' || c == '.' || c == '_' || c == '~') {
      encoded.push_back(c);
    } else {
      const auto byte = static_cast<unsigned char>(c);
      encoded.push_back('%');
      encoded.push_back(kDigits[byte >> 4]);
      encoded.push_back(kDigits[byte & 15]);
    }
  }
  return encoded;
}

std::optional<std::vector<std::string>> decode_path(std::string_view path) {
  std::vector<std::string> segments;
  path.remove_prefix(path.starts_with('/') ? 1 : 0);
  const bool well_formed = for_each_piece(path, '/', [&](std::string_view piece) {
    auto segment = percent_decode(piece, Plus::literal);
    if (!segment) return false;
    segments.push_back(std::move(*segment));
    return true;
  });
  if (!well_formed) return std::nullopt;
  return segments;
}

std::optional<std::vector<QueryPair>> decode_query(std::string_view query) {
  std::vector<QueryPair> pairs;
  const bool well_formed = for_each_piece(query, '&', [&](std::string_view piece) {
    if (piece.empty()) return true;
    const std::size_t equals = std::min(piece.find('='), piece.size());
    auto name = percent_decode(piece.substr(0, equals), Plus::space);
    auto value = percent_decode(piece.substr(std::min(equals + 1, piece.size())), Plus::space);
    if (!name || !value) return false;
    pairs.emplace_back(std::move(*name), std::move(*value));
    return true;
  });
  if (!well_formed) return std::nullopt;
  return pairs;
}

bool is_url_name(std::string_view name) {
  return !name.empty() && name.size() <= kMaxUrlNameLength && std::ranges::all_of(name, [](char c) {
    return is_alphanumeric(c) || c == '_' || c == '-';
  });
}

bool is_allowed_host(std::string_view host, std::span<const std::string> allowed) {
  const std::string name = to_lower(host);
  return std::ranges::any_of(allowed, [&name](const std::string& entry) {
    std::string pattern = to_lower(entry);
    std::string_view asked = name;
    if (end_of_host_name(pattern) == pattern.size())
      asked = asked.substr(0, end_of_host_name(asked));
    if (!pattern.starts_with("*.")) return asked == pattern;
    return asked.size() > pattern.size() - 1 &&
           asked.ends_with(std::string_view(pattern).substr(1));
  });
}

bool is_valid_host(std::string_view host) {
  if (host.empty() || host.size() > 255) return false;
  std::size_t end_of_name = 0;
  if (host.front() == '[') {
    const std::size_t close = host.find(']');
    if (close == std::string_view::npos || close == 1) return false;
    const bool is_ipv6 = std::ranges::all_of(host.substr(1, close - 1), [](char c) {
      return hex_digit(c) >= 0 || c == ':' || c == '.';
    });
    if (!is_ipv6) return false;
    end_of_name = close + 1;
  } else {
    end_of_name = std::min(host.find(':'), host.size());
    const bool is_name = std::ranges::all_of(host.substr(0, end_of_name), [](char c) {
      return is_alphanumeric(c) || c == '-' || c == '.' || c == '_';
    });
    if (end_of_name == 0 || !is_name) return false;
  }
  const std::string_view rest = host.substr(end_of_name);
  return rest.empty() || (rest.front() == ':' && is_valid_port(rest.substr(1)));
}

}  // namespace trapeze
