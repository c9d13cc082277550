// Rows of masks as bits, one a pixel: where values change, and where there are any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace trapeze {

/// Words that hold a bit for every pixel of a row.
constexpr std::size_t words_for(std::size_t pixels) {
  return (pixels + 63) / 64;
}

/// Sets the bits of pixels whose value differs from that of the pixel to their left, and clears no
/// bit. Whether there are any. Precondition: `bits` has words_for(values.size()) words.
bool mark_changes(std::span<const std::uint8_t> values, std::span<std::uint64_t> bits);

/// The same, of the pixels whose value is not 0.
bool mark_covered(std::span<const std::uint8_t> values, std::span<std::uint64_t> bits);

/// The same, of the pixels that are covered in part: whose value is neither 0 nor 255.
bool mark_partial(std::span<const std::uint8_t> values, std::span<std::uint64_t> bits);

}  // namespace trapeze
