// A fast 64-bit checksum (XXH3) against accidental damage; it gives no protection against
// deliberate changes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace trapeze {

std::uint64_t checksum(std::span<const std::byte> bytes);

/// The checksum of a whole file. Throws std::runtime_error that names the path if it cannot be
/// read.
std::uint64_t checksum_of_file(const std::string& path);

template <typename T>
std::uint64_t checksum_of(std::span<const T> items) {
  return checksum(std::as_bytes(items));
}

}  // namespace trapeze
