#include "render/mask/row_bits.h"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include <bit>
#include <cstring>

namespace trapeze {
namespace {

constexpr std::size_t kBlock = 16;

#ifdef __SSE2__

// Sixteen values, and a bit for each by which two of them differ.
using Block = __m128i;

Block block_at(const std::uint8_t* values) {
  Block block;
  std::memcpy(&block, values, sizeof block);
  return block;
}

/// The values before those of the block, which begins a row.
Block before_first(Block block, std::uint8_t) {
  return _mm_or_si128(_mm_slli_si128(block, 1), _mm_and_si128(block, _mm_set_epi32(0, 0, 0, 0xff)));
}

Block zeros() {
  return _mm_setzero_si128();
}

Block all_set() {
  return _mm_set1_epi8(-1);
}

std::uint64_t different(Block a, Block b) {
  return static_cast<std::uint16_t>(~_mm_movemask_epi8(_mm_cmpeq_epi8(a, b)));
}

#else

struct Block {
  std::uint64_t low;
  std::uint64_t high;
};

Block block_at(const std::uint8_t* values) {
  static_assert(std::endian::native == std::endian::little);
  Block block;
  std::memcpy(&block, values, sizeof block);
  return block;
}

Block before_first(Block block, std::uint8_t first) {
  return {block.low << 8 | first, block.high << 8 | block.low >> 56};
}

Block zeros() {
  return {0, 0};
}

Block all_set() {
  return {~std::uint64_t{0}, ~std::uint64_t{0}};
}

/// A bit for each byte that is not 0.
std::uint64_t set_bytes(std::uint64_t bytes) {
  constexpr std::uint64_t kLow = 0x7f7f7f7f7f7f7f7f;
  const std::uint64_t highest = (((bytes & kLow) + kLow) | bytes) & ~kLow;
  return ((highest >> 7) * 0x0102040810204080) >> 56;
}

std::uint64_t different(Block a, Block b) {
  if (a.low == b.low && a.high == b.high) return 0;
  return set_bytes(a.low ^ b.low) | set_bytes(a.high ^ b.high) << 8;
}

#endif

/// Blocks of pixels from `begin` on; calls difference_at(i) for the bits of each, and is_set(i) for
/// pixels of a rest.
template <typename DifferenceAt, typename IsSet>
bool mark_blocks(std::size_t begin, std::size_t pixels, std::span<std::uint64_t> bits,
                 const DifferenceAt& difference_at, const IsSet& is_set) {
  std::uint64_t any = 0;
  const auto mark = [&](std::size_t i, std::uint64_t set) {
    bits[i / 64] |= set << i % 64;
    any |= set;
  };
  std::size_t i = begin;
  for (; i + kBlock <= pixels; i += kBlock) mark(i, difference_at(i));
  for (; i < pixels; ++i) mark(i, is_set(i) ? 1 : 0);
  return any != 0;
}

}  // namespace

bool mark_changes(std::span<const std::uint8_t> values, std::span<std::uint64_t> bits) {
  const std::uint8_t* const row = values.data();
  std::uint64_t first = 0;
  std::size_t begin = 0;
  if (values.size() >= kBlock) {
    const Block block = block_at(row);
    first = different(block, before_first(block, row[0]));
    bits[0] |= first;
    begin = kBlock;
  }
  const bool any = mark_blocks(
      begin, values.size(), bits,
      [row](std::size_t i) { return different(block_at(row + i), block_at(row + i - 1)); },
      [row](std::size_t i) { return i > 0 && row[i] != row[i - 1]; });
  return any || first != 0;
}

bool mark_covered(std::span<const std::uint8_t> values, std::span<std::uint64_t> bits) {
  const std::uint8_t* const row = values.data();
  return mark_blocks(
      0, values.size(), bits,
      [row](std::size_t i) { return different(block_at(row + i), zeros()); },
      [row](std::size_t i) { return row[i] != 0; });
}

bool mark_partial(std::span<const std::uint8_t> values, std::span<std::uint64_t> bits) {
  const std::uint8_t* const row = values.data();
  return mark_blocks(
      0, values.size(), bits,
      [row](std::size_t i) {
        const Block block = block_at(row + i);
        return different(block, zeros()) & different(block, all_set());
      },
      [row](std::size_t i) { return row[i] != 0 && row[i] != 255; });
}

}  // namespace trapeze
