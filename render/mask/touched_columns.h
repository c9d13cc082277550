// Records which columns of the rows of a picture have been written, as 64 blocks per row.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace trapeze {

/// Calls act(begin, end) for the columns of blocks whose bit is set, with adjacent blocks joined:
/// bit b represents the columns from b << shift on.
template <typename Act>
void for_each_touched(std::uint64_t touched, unsigned shift, std::size_t columns, const Act& act) {
  const auto column_of = [&](int bit) {
    return std::min(static_cast<std::size_t>(bit) << shift, columns);
  };
  while (touched != 0) {
    const int first = std::countr_zero(touched);
    const int end = first + std::countr_one(touched >> first);
    act(column_of(first), column_of(end));
    touched = end < 64 ? touched >> end << end : 0;
  }
}

class TouchedColumns {
 public:
  /// Resets all rows to untouched.
  void assign(std::size_t columns, std::size_t rows) {
    by_row_.assign(rows, 0);
    shift_ = 3;
    while ((columns - 1) >> shift_ >= 64) ++shift_;
  }
  /// Marks the columns from `first` to `last`.
  void touch(std::size_t row, std::size_t first, std::size_t last) {
    touch(row, bits_of(first, last));
  }
  /// The same for columns that several rows share.
  void touch(std::size_t row, std::uint64_t bits) { by_row_[row] |= bits; }
  std::uint64_t bits_of(std::size_t first, std::size_t last) const {
    const std::uint64_t from_first = ~std::uint64_t{0} << (first >> shift_);
    const std::uint64_t to_last = ~std::uint64_t{0} >> (63 - (last >> shift_));
    return from_first & to_last;
  }
  /// The bits of a row; see for_each_touched().
  std::uint64_t of(std::size_t row) const { return by_row_[row]; }
  /// Returns the bits of a row and clears them; see for_each_touched().
  std::uint64_t take(std::size_t row) { return std::exchange(by_row_[row], 0); }
  unsigned shift() const { return shift_; }

 private:
  std::vector<std::uint64_t> by_row_;
  unsigned shift_ = 3;
};

}  // namespace trapeze
