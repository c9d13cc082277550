// The values of a mask while they are computed, in any order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/mask/mask.h"
#include "render/mask/touched_columns.h"

namespace trapeze {

/// Use it for one mask after the other: the cost depends only on the part that is written.
class Canvas {
 public:
  /// Starts a mask with all values 0. An unfinished mask is discarded.
  void begin(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  /// The values of a row, of which columns `begin` to `end` - 1 will be written. Precondition:
  /// begin < end.
  std::uint8_t* row(int row, int begin, int end) {
    const auto i = static_cast<std::size_t>(row);
    touched_.touch(i, static_cast<std::size_t>(begin), static_cast<std::size_t>(end) - 1);
    return values_.data() + i * static_cast<std::size_t>(width_);
  }
  /// The same for the columns of a result of touched(), which several rows may share.
  std::uint8_t* row(int row, std::uint64_t touched) {
    const auto i = static_cast<std::size_t>(row);
    touched_.touch(i, touched);
    return values_.data() + i * static_cast<std::size_t>(width_);
  }
  std::uint64_t touched(int begin, int end) const {
    return touched_.bits_of(static_cast<std::size_t>(begin), static_cast<std::size_t>(end) - 1);
  }
  /// Calls act(begin, end) for columns of a row that include all written ones, in order.
  template <typename Act>
  void for_each_written(int row, const Act& act) const {
    for_each_touched(touched_.of(static_cast<std::size_t>(row)), touched_.shift(),
                     static_cast<std::size_t>(width_), act);
  }
  /// Finishes the mask.
  void finish(Mask& mask);

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> values_;  // all 0 between two masks
  TouchedColumns touched_;
  bool is_clean_ = true;
};

}  // namespace trapeze
