#include "render/mask/resolve_row.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <utility>

#include "render/mask/row_bits.h"
#include "render/mask/touched_columns.h"

namespace trapeze {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kBlock = 8;  // pixels computed at the same time

constexpr float kValuesPerUnit = 255.0f / kUnitsPerPixel;

// Uses the vector extensions of g++ and clang: the same operations in the same order, so the values
// do not depend on the instruction set of the processor.
using Integers __attribute__((vector_size(kBlock * sizeof(std::int32_t)))) = std::int32_t;
using Floats __attribute__((vector_size(kBlock * sizeof(float)))) = float;
using Bytes __attribute__((vector_size(kBlock))) = std::uint8_t;

/// A row while it is computed.
struct Row {
  std::array<std::uint8_t, kMaxPicturePixels> values;  // valid where touched
  // By pixel, whether its value differs from that of the previous pixel.
  std::array<std::uint64_t, words_for(kMaxPicturePixels)> changes;

  explicit Row(std::size_t columns) { std::fill_n(changes.data(), words_for(columns), 0); }
};

/// The state before a span of columns: the sum of all earlier differences, and the last value.
struct Before {
  std::int32_t sum = 0;
  std::uint8_t value = 0;
};

/// Computes the values of the columns from `begin` to `end` - 1; both are multiples of kBlock.
[[gnu::always_inline]] inline void sum_blocks(std::int32_t* differences, std::size_t begin,
                                              std::size_t end, Before& before, Row& row) {
  constexpr Integers kNone{};
  Integers sum_before = kNone + before.sum;
  std::uint64_t value_before = before.value;
  auto* changes = reinterpret_cast<std::uint8_t*>(row.changes.data());
  for (std::size_t i = begin; i < end; i += kBlock) {
    Integers sums;
    std::memcpy(&sums, differences + i, sizeof sums);
    std::memset(differences + i, 0, sizeof sums);
    sums += __builtin_shufflevector(kNone, sums, 0, 8, 9, 10, 11, 12, 13, 14);
    sums += __builtin_shufflevector(kNone, sums, 0, 1, 8, 9, 10, 11, 12, 13);
    sums += __builtin_shufflevector(kNone, sums, 0, 1, 2, 3, 8, 9, 10, 11);
    sums += sum_before;
    sum_before = __builtin_shufflevector(sums, sums, 7, 7, 7, 7, 7, 7, 7, 7);
    Floats shares = __builtin_convertvector(sums, Floats) * kValuesPerUnit;
    const Floats zero{};
    const Floats all = zero + 255.0f;
    shares = shares < zero ? zero : shares;
    shares = shares > all ? all : shares;
    const auto rounded = __builtin_convertvector(shares + 0.5f, Integers);
    const auto bytes = __builtin_convertvector(rounded, Bytes);
    std::uint64_t values = 0;
    std::memcpy(&values, &bytes, sizeof values);
    std::memcpy(row.values.data() + i, &values, sizeof values);
    changes[i / kBlock] = set_bytes(values ^ (values << 8 | value_before));
    value_before = values >> 56;
  }
  before.sum = sum_before[0];
  before.value = static_cast<std::uint8_t>(value_before);
}

using SumBlocks = void (*)(std::int32_t*, std::size_t, std::size_t, Before&, Row&);

void sum_blocks_anywhere(std::int32_t* differences, std::size_t begin, std::size_t end,
                         Before& before, Row& row) {
  sum_blocks(differences, begin, end, before, row);
}

#ifdef __x86_64__

[[gnu::target("avx2")]] void sum_blocks_with_avx2(std::int32_t* differences, std::size_t begin,
                                                  std::size_t end, Before& before, Row& row) {
  sum_blocks(differences, begin, end, before, row);
}

SumBlocks best_sum_blocks() {
  return __builtin_cpu_supports("avx2") ? sum_blocks_with_avx2 : sum_blocks_anywhere;
}

#else

SumBlocks best_sum_blocks() {
  return sum_blocks_anywhere;
}

#endif

/// Processes a row of differences and sets them to 0.
class RowSum {
 public:
  explicit RowSum(std::span<std::int32_t> differences)
      : differences_(differences), row_(differences.size()) {}

  /// Processes some columns; all between them and those processed before are 0. Precondition: begin
  /// is a multiple of kBlock, and end is one or is the end of the row.
  void take(std::size_t begin, std::size_t end) {
    static const SumBlocks sum = best_sum_blocks();
    const std::size_t whole_blocks = begin + (end - begin) / kBlock * kBlock;
    sum(differences_.data(), begin, whole_blocks, before_, row_);
    if (whole_blocks < end) take_rest(whole_blocks, end - whole_blocks);
  }
  /// Appends the row to a mask.
  void finish(Mask& mask) {
    const std::size_t columns = differences_.size();
    const std::span<std::uint64_t> changes(row_.changes.data(), words_for(columns));
    std::uint8_t value = 0;  // of the current run
    if ((changes[0] & 1) != 0) value = row_.values[0];
    changes[0] &= ~std::uint64_t{1};
    for_each_bit(changes, [&](std::size_t column) {
      mask.append_new(column, value);
      value = row_.values[column];
    });
    mask.append_new(columns, value);
    mask.end_row();
  }

 private:
  // The columns after the rest are 0, so nothing changes there.
  void take_rest(std::size_t column, std::size_t count) {
    std::array<std::int32_t, kBlock> rest{};
    const auto here = differences_.subspan(column, count);
    std::ranges::copy(here, rest.begin());
    std::ranges::fill(here, 0);
    Row of_rest(kBlock);
    sum_blocks_anywhere(rest.data(), 0, kBlock, before_, of_rest);
    std::copy_n(of_rest.values.data(), count, row_.values.data() + column);
    row_.changes[column / 64] |= of_rest.changes[0] << column % 64;
  }

  std::span<std::int32_t> differences_;
  Before before_;
  Row row_;
};

bool is_all_zero(const std::int32_t* differences) {
  const auto pair = [differences](std::size_t i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, differences + 2 * i, sizeof bits);
    return bits;
  };
  return (pair(0) | pair(1) | pair(2) | pair(3)) == 0;
}

}  // namespace

// Blocks of zeros continue the current run.
void resolve_row(std::span<std::int32_t> differences, Mask& mask) {
  RowSum sum(differences);
  std::size_t i = 0;
  while (i + kBlock <= differences.size()) {
    std::size_t end = i;
    while (end + kBlock <= differences.size() && !is_all_zero(differences.data() + end)) {
      end += kBlock;
    }
    if (end > i) sum.take(i, end);
    i = end > i ? end : i + kBlock;
  }
  sum.take(i, differences.size());
  sum.finish(mask);
}

void resolve_row(std::span<std::int32_t> differences, std::uint64_t touched, unsigned shift,
                 Mask& mask) {
  RowSum sum(differences);
  for_each_touched(touched, shift, differences.size(),
                   [&](std::size_t begin, std::size_t end) { sum.take(begin, end); });
  sum.finish(mask);
}

// Clamped sums have differences of 32 bits, and give the same values.
void resolve_row(std::span<std::int64_t> differences, Mask& mask) {
  std::array<std::int32_t, kMaxPicturePixels> clamped;
  std::int64_t sum = 0;
  std::int32_t before = 0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    sum += std::exchange(differences[i], 0);
    const auto here = static_cast<std::int32_t>(std::clamp<std::int64_t>(sum, 0, kUnitsPerPixel));
    clamped[i] = here - before;
    before = here;
  }
  resolve_row({clamped.data(), differences.size()}, mask);
}

}  // namespace trapeze
