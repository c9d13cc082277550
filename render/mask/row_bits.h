// Rows of masks as one bit per pixel: where values change, and where they are not 0.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "render/mask/mask.h"

namespace trapeze {

/// The number of words with a bit for every pixel of a row.
constexpr std::size_t words_for(std::size_t pixels) {
  return (pixels + 63) / 64;
}

/// One bit for each of eight bytes, set if the byte is not 0, the lowest byte first.
[[gnu::always_inline]] inline std::uint8_t set_bytes(std::uint64_t bytes) {
  constexpr std::uint64_t kLow = 0x7f7f7f7f7f7f7f7f;
  const std::uint64_t highest = (((bytes & kLow) + kLow) | bytes) & ~kLow;
  return static_cast<std::uint8_t>(((highest >> 7) * 0x0102040810204080) >> 56);
}

/// Sets the bits of the pixels from `begin` to `end` - 1, and clears none. Precondition: begin <
/// end.
inline void set_bits(std::size_t begin, std::size_t end, std::span<std::uint64_t> bits) {
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  const std::size_t first = begin / 64;
  const std::size_t last = (end - 1) / 64;
  const std::uint64_t from_begin = kAll << begin % 64;
  const std::uint64_t to_end = kAll >> (63 - (end - 1) % 64);
  if (first == last) {
    bits[first] |= from_begin & to_end;
    return;
  }
  bits[first] |= from_begin;
  std::fill(bits.begin() + static_cast<std::ptrdiff_t>(first) + 1,
            bits.begin() + static_cast<std::ptrdiff_t>(last), kAll);
  bits[last] |= to_end;
}

/// Calls act(i) for every set bit, in order.
template <typename Act>
void for_each_bit(std::span<const std::uint64_t> bits, const Act& act) {
  for (std::size_t word = 0; word < bits.size(); ++word) {
    for (std::uint64_t rest = bits[word]; rest != 0; rest &= rest - 1) {
      act(word * 64 + static_cast<std::size_t>(std::countr_zero(rest)));
    }
  }
}

/// Calls act(begin, end) for every run of set bits among the first `count`.
template <typename Act>
void for_each_run_of_bits(std::span<const std::uint64_t> bits, std::size_t count, const Act& act) {
  const auto next = [&](std::size_t from, std::uint64_t flip) {
    while (from < count) {
      const std::uint64_t rest = (bits[from / 64] ^ flip) >> from % 64;
      if (rest != 0)
        return std::min(count, from + static_cast<std::size_t>(std::countr_zero(rest)));
      from = (from / 64 + 1) * 64;
    }
    return count;
  };
  for (std::size_t end = 0; end < count;) {
    const std::size_t begin = next(end, 0);
    if (begin == count) return;
    end = next(begin, ~std::uint64_t{0});
    act(begin, end);
  }
}

/// Sets the bits of pixels whose value differs from that of the pixel to their left, and clears
/// none. Precondition: `bits` has words_for() the pixels of the row.
void mark_changes(std::span<const MaskRun> row, std::span<std::uint64_t> bits);

/// The same for pixels whose value is not 0.
void mark_covered(std::span<const MaskRun> row, std::span<std::uint64_t> bits);

/// The same for partially covered pixels, whose value is neither 0 nor 255. Returns whether there
/// are any.
bool mark_partial(std::span<const MaskRun> row, std::span<std::uint64_t> bits);

}  // namespace trapeze
