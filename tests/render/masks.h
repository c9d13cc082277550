// Builds masks from pixels and reads their pixels, for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/mask/mask.h"

namespace trapeze::testing {

/// A mask whose pixels are value_at(column, row).
template <typename ValueAt>
Mask mask_by(int width, int height, const ValueAt& value_at) {
  Mask mask;
  mask.begin(width, height);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      mask.append(static_cast<std::size_t>(column) + 1,
                  static_cast<std::uint8_t>(value_at(column, row)));
    }
    mask.end_row();
  }
  return mask;
}

/// The values of all pixels, row by row.
inline std::vector<std::uint8_t> values_of(const Mask& mask) {
  std::vector<std::uint8_t> values;
  for (int row = 0; row < mask.height(); ++row) {
    const std::size_t begin = values.size();
    for (const MaskRun& run : mask.row(row)) values.resize(begin + run.end, run.value);
  }
  return values;
}

}  // namespace trapeze::testing
