#include "render/mask/canvas.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/render/masks.h"

namespace trapeze {
namespace {

TEST(CanvasTest, HasWhatWasWrittenAndNothingOfTheMasksBefore) {
  std::mt19937 random(4);
  Canvas canvas;
  for (const int width : {1, 7, 64, 65, 300, 300, 700}) {
    for (int round = 0; round < 5; ++round) {
      constexpr int kRows = 9;
      std::vector<std::uint8_t> expected(static_cast<std::size_t>(width * kRows), 0);
      canvas.begin(width, kRows);
      for (int i = 0; i < 20; ++i) {
        const int row = static_cast<int>(random() % kRows);
        const int begin = static_cast<int>(random() % static_cast<unsigned>(width));
        const int end =
            begin + 1 + static_cast<int>(random() % static_cast<unsigned>(width - begin));
        const auto value = static_cast<std::uint8_t>(random() % 3 * 100);
        std::uint8_t* values = canvas.row(row, begin, end);
        for (int k = begin; k < end; ++k) {
          values[k] = expected[static_cast<std::size_t>(row * width + k)] = value;
        }
      }
      if (round == 3) continue;  // an unfinished mask is dropped
      Mask mask;
      canvas.finish(mask);
      ASSERT_EQ(testing::values_of(mask), expected) << width;
    }
  }
}

}  // namespace
}  // namespace trapeze
