#include "render/mask/resolve_row.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "render/mask/touched_columns.h"
#include "tests/render/masks.h"

namespace trapeze {
namespace {

// Non-zero differences in a few places.
std::vector<std::int32_t> random_differences(std::mt19937& random, std::size_t columns) {
  std::vector<std::int32_t> differences(columns, 0);
  for (std::size_t i = 0; i < columns; i += 1 + random() % 40) {
    differences[i] = static_cast<std::int32_t>(random() % 700'000) - 350'000;
  }
  return differences;
}

std::vector<std::uint8_t> one_by_one(const std::vector<std::int32_t>& differences) {
  std::vector<std::uint8_t> values;
  double sum = 0;
  for (const std::int32_t difference : differences) {
    sum += difference;
    const double share = std::clamp(sum / kUnitsPerPixel, 0.0, 1.0);
    values.push_back(static_cast<std::uint8_t>(share * 255 + 0.5));
  }
  return values;
}

bool is_canonical(const Mask& mask) {
  const auto runs = mask.row(0);
  return std::ranges::adjacent_find(runs, {}, &MaskRun::value) == runs.end();
}

TEST(ResolveRowTest, EveryWayHasTheRunningSums) {
  std::mt19937 random(12);
  for (const std::size_t columns : {1u, 5u, 8u, 9u, 63u, 64u, 256u, 257u, 1030u}) {
    for (int round = 0; round < 20; ++round) {
      const std::vector<std::int32_t> differences = random_differences(random, columns);
      const auto width = static_cast<int>(columns);
      Mask mask;
      mask.begin(width, 3);

      std::vector<std::int32_t> all = differences;
      resolve_row(all, mask);

      TouchedColumns touched;
      touched.assign(columns, 1);
      for (std::size_t i = 0; i < columns; ++i) {
        if (differences[i] != 0) touched.touch(0, i, i);
      }
      std::vector<std::int32_t> some = differences;
      resolve_row(some, touched.take(0), touched.shift(), mask);

      std::vector<std::int64_t> wide(differences.begin(), differences.end());
      resolve_row(wide, mask);

      const std::vector<std::uint8_t> expected = one_by_one(differences);
      std::vector<std::uint8_t> three;
      for (int i = 0; i < 3; ++i) three.insert(three.end(), expected.begin(), expected.end());
      ASSERT_EQ(testing::values_of(mask), three) << columns;
      ASSERT_TRUE(is_canonical(mask));
      ASSERT_EQ(all, std::vector<std::int32_t>(columns, 0)) << "they are set to 0";
      ASSERT_EQ(some, all);
      ASSERT_EQ(wide, std::vector<std::int64_t>(columns, 0));
    }
  }
}

TEST(ResolveRowTest, WideSumsMayBeMoreThan32BitsHold) {
  std::vector<std::int64_t> differences(9, 0);
  differences[1] = std::int64_t{1} << 40;
  differences[3] = -(std::int64_t{1} << 41);
  differences[6] = (std::int64_t{1} << 40) + kUnitsPerPixel / 5;
  Mask mask;
  mask.begin(9, 1);
  resolve_row(differences, mask);
  EXPECT_EQ(testing::values_of(mask),
            (std::vector<std::uint8_t>{0, 255, 255, 0, 0, 0, 51, 51, 51}));
}

}  // namespace
}  // namespace trapeze
