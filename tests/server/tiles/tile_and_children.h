// Compares a tile of 512 pixels with its four children.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>

#include "render/picture/compose.h"

namespace trapeze::testing {

/// Expects the opacities of a tile at twice the scale to equal those of its children, except for
/// rounding. Order of the children: north-west, north-east, south-west, south-east.
inline void expect_children_are_alike(const Picture& parent,
                                      const std::array<Picture, 4>& children) {
  ASSERT_EQ(parent.width, 512);
  int different = 0;
  for (int row = 0; row < 512; ++row) {
    for (int column = 0; column < 512; ++column) {
      const std::size_t child =
          2u * static_cast<unsigned>(row / 256) + static_cast<unsigned>(column / 256);
      const int a = parent.at(column, row).a;
      const int b = children[child].at(column % 256, row % 256).a;
      if (std::abs(a - b) > 1) ++different;
    }
  }
  EXPECT_EQ(different, 0);
}

}  // namespace trapeze::testing
