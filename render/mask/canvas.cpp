#include "render/mask/canvas.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "render/mask/row_bits.h"

namespace trapeze {
namespace {

/// Converts the values of a row to runs; columns that are not passed to take() are 0.
class RowRuns {
 public:
  explicit RowRuns(Mask& mask) : mask_(mask) {}

  /// Adds the values of some columns, which must come after those added before; skipped columns are
  /// 0.
  void take(const std::uint8_t* values, std::size_t begin, std::size_t end) {
    if (begin > done_) take_next(done_, 0);
    std::size_t i = begin;
    for (; i + kBytes <= end; i += kBytes) {
      std::uint64_t bytes = 0;
      std::memcpy(&bytes, values + i, kBytes);
      const std::uint64_t before = bytes << 8 | value_;
      for (unsigned changes = set_bytes(bytes ^ before); changes != 0; changes &= changes - 1) {
        const std::size_t column = i + static_cast<std::size_t>(std::countr_zero(changes));
        take_next(column, values[column]);
      }
    }
    for (; i < end; ++i) take_next(i, values[i]);
    done_ = end;
  }
  void finish(std::size_t columns) {
    if (done_ < columns) take_next(done_, 0);
    mask_.append_new(columns, value_);
    mask_.end_row();
  }

 private:
  static constexpr std::size_t kBytes = sizeof(std::uint64_t);
  static_assert(std::endian::native == std::endian::little);

  void take_next(std::size_t column, std::uint8_t value) {
    if (value == value_) return;
    if (column > 0) mask_.append_new(column, value_);
    value_ = value;
  }

  Mask& mask_;
  std::size_t done_ = 0;    // columns
  std::uint8_t value_ = 0;  // of the current run
};

}  // namespace

void Canvas::begin(int width, int height) {
  if (width != width_ || height != height_ || !is_clean_) {
    width_ = height_ = 0;  // if memory runs out below, the next call starts over
    const auto columns = static_cast<std::size_t>(width);
    const auto rows = static_cast<std::size_t>(height);
    values_.assign(columns * rows, 0);
    touched_.assign(columns, rows);
    width_ = width;
    height_ = height;
  }
  is_clean_ = false;
}

void Canvas::finish(Mask& mask) {
  mask.begin(width_, height_);
  const auto columns = static_cast<std::size_t>(width_);
  for (int row = 0; row < height_; ++row) {
    const auto i = static_cast<std::size_t>(row);
    std::uint8_t* values = values_.data() + i * columns;
    RowRuns runs(mask);
    for_each_touched(touched_.take(i), touched_.shift(), columns,
                     [&](std::size_t begin, std::size_t end) {
                       runs.take(values, begin, end);
                       std::fill(values + begin, values + end, std::uint8_t{0});
                     });
    runs.finish(columns);
  }
  is_clean_ = true;
}

}  // namespace trapeze
