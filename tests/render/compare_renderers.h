// Measures the difference between two renderers or two pictures.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <span>

#include "render/mask/mask.h"

namespace trapeze::testing {

/// Counts of pixels by the difference between their values.
struct Difference {
  std::size_t pixels = 0;
  std::size_t above_1 = 0;  // pixels that differ by more than 1/255
  int worst = 0;            // in 255ths
  int worst_column = -1;
  int worst_row = -1;

  /// Within 2/255 everywhere and within 1/255 in 99.9 % of the pixels.
  bool is_within_bounds() const;
};
std::ostream& operator<<(std::ostream& out, const Difference& difference);

/// The two masks must have the same size.
Difference compare_masks(const Mask& expected, const Mask& actual);

Difference compare_renderers(MaskRenderer& expected, MaskRenderer& actual, const MeshView& mesh,
                             std::span<const TrapezoidRange> ranges, const View& view);

}  // namespace trapeze::testing
