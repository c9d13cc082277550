// Addresses of clients, ranges of addresses, and what proxies report about clients.
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

/// An IPv6 address, or an IPv4 address mapped to IPv6 (::ffff:a.b.c.d).
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

/// Nothing if the text is not an IPv4 or IPv6 address.
std::optional<ClientAddress> parse_address(std::string_view text);

/// The usual text form: "192.0.2.7", "2001:db8::1".
std::string address_text(const ClientAddress& address);

/// All addresses that begin with the same bits.
struct AddressRange {
  ClientAddress first;
  int bits = 128;  // of the 128 bits of an address

  bool contains(const ClientAddress& address) const;
};

/// Parses "10.0.0.0/8", "2001:db8::/32", or a single address. Nothing for other text.
std::optional<AddressRange> parse_address_range(std::string_view text);

/// The client behind trusted proxies: the last address of `forwarded_for` (the value of
/// X-Forwarded-For) that is not trusted itself. Returns `peer`, the other end of the connection, if
/// it is not trusted, or if the header contains something other than an address there, with or
/// without a port. Entries that an untrusted client wrote into the header itself are never
/// believed.
ClientAddress client_behind(const ClientAddress& peer, std::string_view forwarded_for,
                            std::span<const AddressRange> trusted);

/// The address by which limits are counted: an IPv4 address, or the /64 of an IPv6 address, since
/// one client usually has a whole /64.
ClientAddress limited_address(const ClientAddress& address);

}  // namespace trapeze
