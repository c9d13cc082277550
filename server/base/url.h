// The parts of a request target, decoded strictly: malformed text is refused, not guessed.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace trapeze {

/// Views into the target that was split, which must outlive it.
struct Target {
  std::string_view path;       // still encoded; begins with '/'
  std::string_view query;      // still encoded, without '?'
  std::string_view host = {};  // of the absolute form, with its port, unchecked; otherwise empty
};

/// Splits "/path?query", or the absolute form "http://host/path?query", in which a missing path is
/// "/". Nothing for other text.
std::optional<Target> split_target(std::string_view target);

enum class Plus { literal, space };

/// Nothing if a '%' is not followed by two hex digits, or if the result contains a control
/// character.
std::optional<std::string> percent_decode(std::string_view text, Plus plus);

/// Whether the text contains a control character, which no URL may contain, not even encoded.
bool has_control_character(std::string_view text);

/// Encodes everything except letters, digits and -._~, so the result can be used anywhere in a URL.
std::string percent_encode(std::string_view text);

/// The decoded segments between the slashes of a path ("/a/b" has two, "/" has one, which is
/// empty). A decoded segment may contain anything printable, including slashes. Nothing if one is
/// malformed.
std::optional<std::vector<std::string>> decode_path(std::string_view path);

using QueryPair = std::pair<std::string, std::string>;

/// The decoded name=value pairs in order; a name without '=' has an empty value, empty pairs are
/// left out. Nothing if one is malformed.
std::optional<std::vector<QueryPair>> decode_query(std::string_view query);

constexpr std::size_t kMaxUrlNameLength = 64;

/// Whether `name` is valid as the name of a layer or a style in a URL: 1 to 64 of A-Z, a-z, 0-9,
/// '_' and '-'.
bool is_url_name(std::string_view name);

/// Whether `host` is valid as the host of an absolute URL: a name, an IPv4 or a bracketed IPv6
/// address, with or without a port.
bool is_valid_host(std::string_view host);

/// Whether one of `allowed` matches the valid host, ignoring case: an entry without a port matches
/// every port; "*.name" matches every name that ends with ".name".
bool is_allowed_host(std::string_view host, std::span<const std::string> allowed);

}  // namespace trapeze
