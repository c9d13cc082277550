#include "tests/render/compare_renderers.h"

#include <cstdlib>
#include <ostream>
#include <stdexcept>

#include "tests/render/masks.h"

namespace trapeze::testing {

bool Difference::is_within_bounds() const {
  return worst <= 2 && above_1 * 1000 <= pixels;
}

std::ostream& operator<<(std::ostream& out, const Difference& difference) {
  return out << difference.above_1 << " of " << difference.pixels
             << " pixels differ by more than 1, at most by " << difference.worst << " in column "
             << difference.worst_column << ", row " << difference.worst_row;
}

Difference compare_masks(const Mask& expected, const Mask& actual) {
  if (expected.width() != actual.width() || expected.height() != actual.height()) {
    throw std::invalid_argument("the masks are of different sizes");
  }
  Difference difference;
  difference.pixels =
      static_cast<std::size_t>(expected.width()) * static_cast<std::size_t>(expected.height());
  const std::vector<std::uint8_t> expected_values = values_of(expected);
  const std::vector<std::uint8_t> actual_values = values_of(actual);
  for (int row = 0; row < expected.height(); ++row) {
    for (int column = 0; column < expected.width(); ++column) {
      const auto i = static_cast<std::size_t>(row * expected.width() + column);
      const int apart = std::abs(expected_values[i] - actual_values[i]);
      difference.above_1 += apart > 1 ? 1 : 0;
      if (apart <= difference.worst) continue;
      difference.worst = apart;
      difference.worst_column = column;
      difference.worst_row = row;
    }
  }
  return difference;
}

Difference compare_renderers(MaskRenderer& expected, MaskRenderer& actual, const MeshView& mesh,
                             std::span<const TrapezoidRange> ranges, const View& view) {
  Mask from_expected;
  Mask from_actual;
  expected.draw(mesh, ranges, view, from_expected);
  actual.draw(mesh, ranges, view, from_actual);
  return compare_masks(from_expected, from_actual);
}

}  // namespace trapeze::testing
