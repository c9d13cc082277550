#include "server/http/client_address.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>

#include "server/base/trimmed.h"

namespace trapeze {
namespace {

constexpr std::array<std::uint8_t, 12> kIpv4Prefix = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
constexpr std::size_t kLimitedIpv6Bytes = 8;  // a /64

bool is_trusted(const ClientAddress& address, std::span<const AddressRange> trusted) {
  return std::ranges::any_of(
      trusted, [&address](const AddressRange& range) { return range.contains(address); });
}

std::optional<int> parse_number(std::string_view text, int most) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (number < 0 || number > most) return std::nullopt;
  return number;
}

/// The address in an entry of X-Forwarded-For: some proxies append ports, "192.0.2.7:1234" and
/// "[2001:db8::1]:1234". An IPv6 address without brackets has no port.
std::optional<ClientAddress> parse_forwarded(std::string_view text) {
  std::string_view address = text;
  if (text.starts_with('[')) {
    const std::size_t end = text.find(']');
    if (end == std::string_view::npos) return std::nullopt;
    address = text.substr(1, end - 1);
    text.remove_prefix(end + 1);
  } else {
    const std::size_t colon = std::min(text.find(':'), text.size());
    if (text.find('.') < colon) address = text.substr(0, colon);
    text.remove_prefix(address.size());
  }
  constexpr int kLastPort = 65535;
  const bool has_port =
      text.starts_with(':') && parse_number(text.substr(1), kLastPort).has_value();
  if (!text.empty() && !has_port) return std::nullopt;
  return parse_address(address);
}

}  // namespace

bool ClientAddress::is_ipv4() const {
  return std::equal(kIpv4Prefix.begin(), kIpv4Prefix.end(), bytes.begin());
}

std::optional<ClientAddress> parse_address(std::string_view text) {
  const std::string terminated(text);
  if (terminated.find('\0') != std::string::npos) return std::nullopt;
  ClientAddress address;
  if (inet_pton(AF_INET6, terminated.c_str(), address.bytes.data()) == 1) return address;
  std::ranges::copy(kIpv4Prefix, address.bytes.begin());
  if (inet_pton(AF_INET, terminated.c_str(), &address.bytes[kIpv4Prefix.size()]) == 1) {
    return address;
  }
  return std::nullopt;
}

std::string address_text(const ClientAddress& address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  const bool is_ipv4 = address.is_ipv4();
  inet_ntop(is_ipv4 ? AF_INET : AF_INET6, address.bytes.data() + (is_ipv4 ? kIpv4Prefix.size() : 0),
            text.data(), text.size());
  return text.data();
}

bool AddressRange::contains(const ClientAddress& address) const {
  const auto whole = static_cast<std::size_t>(bits / 8);
  if (!std::equal(first.bytes.begin(), first.bytes.begin() + static_cast<std::ptrdiff_t>(whole),
                  address.bytes.begin())) {
    return false;
  }
  const int rest = bits % 8;
  return rest == 0 || (first.bytes[whole] ^ address.bytes[whole]) >> (8 - rest) == 0;
}

std::optional<AddressRange> parse_address_range(std::string_view text) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const auto first = parse_address(text.substr(0, slash));
  if (!first) return std::nullopt;
  if (slash == text.size()) return AddressRange{*first, 128};
  const bool is_ipv4 = first->is_ipv4() && text.find(':') == std::string_view::npos;
  const auto bits = parse_number(text.substr(slash + 1), is_ipv4 ? 32 : 128);
  if (!bits) return std::nullopt;
  return AddressRange{*first, *bits + (is_ipv4 ? 96 : 0)};
}

ClientAddress client_behind(const ClientAddress& peer, std::string_view forwarded_for,
                            std::span<const AddressRange> trusted) {
  ClientAddress client = peer;
  // From the right: each proxy appended the address of its peer.
  while (!forwarded_for.empty() && is_trusted(client, trusted)) {
    const std::size_t comma = forwarded_for.rfind(',');
    const bool is_last = comma == std::string_view::npos;
    const auto said = parse_forwarded(trimmed(forwarded_for.substr(is_last ? 0 : comma + 1)));
    if (!said) break;
    client = *said;
    forwarded_for = is_last ? std::string_view() : forwarded_for.substr(0, comma);
  }
  return client;
}

ClientAddress limited_address(const ClientAddress& address) {
  if (address.is_ipv4()) return address;
  ClientAddress limited = address;
  std::fill(limited.bytes.begin() + kLimitedIpv6Bytes, limited.bytes.end(), std::uint8_t{0});
  return limited;
}

}  // namespace trapeze
