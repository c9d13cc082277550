// Whose request it is: addresses, ranges of them, and what proxies say about them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace trapeze {

/// An IPv6 address, or an IPv4 address as IPv6 writes it (::ffff:a.b.c.d).
struct ClientAddress {
  std::array<std::uint8_t, 16> bytes{};

  bool is_ipv4() const;
  friend bool operator==(const ClientAddress&, const ClientAddress&) = default;
};

struct ClientAddressHash {
  std::size_t operator()(const ClientAddress& address) const {
    return std::hash<std::string_view>()(
        {reinterpret_cast<const char*>(address.bytes.data()), address.bytes.size()});
  }
};

/// Nothing if the text is no IPv4 or IPv6 address.
std::optional<ClientAddress> parse_address(std::string_view text);

/// As it is written: "192.0.2.7", "2001:db8::1".
std::string address_text(const ClientAddress& address);

/// All addresses that begin with the same bits.
struct AddressRange {
  ClientAddress first;
  int bits = 128;  // of the sixteen bytes

  bool contains(const ClientAddress& address) const;
};

/// "10.0.0.0/8", "2001:db8::/32", or one address. Nothing for other text.
std::optional<AddressRange> parse_address_range(std::string_view text);

/// The client behind proxies that are trusted: the last address of `forwarded_for` (the value of
/// X-Forwarded-For) that is not itself trusted. `peer`, who opened the connection, if it is not
/// trusted, or if what it says is no address. What an untrusted client writes into the header
/// itself is never believed.
ClientAddress client_behind(const ClientAddress& peer, std::string_view forwarded_for,
                            std::span<const AddressRange> trusted);

/// What limits are counted by: an IPv4 address, or the /64 of an IPv6 one, of which a single client
/// has them all.
ClientAddress limited_address(const ClientAddress& address);

}  // namespace trapeze
