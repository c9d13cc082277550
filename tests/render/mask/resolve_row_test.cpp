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

// Differences in a few places; multiples of 1/256, so that no sum is rounded.
std::vector<float> random_differences(std::mt19937& random, std::size_t columns) {
  std::vector<float> differences(columns, 0);
  for (std::size_t i = 0; i < columns; i += 1 + random() % 40) {
    differences[i] = static_cast<float>(static_cast<int>(random() % 700) - 350) / 256;
  }
  return differences;
}

std::vector<std::uint8_t> one_by_one(const std::vector<float>& differences) {
  std::vector<std::uint8_t> values;
  float sum = 0;
  for (const float difference : differences) {
    sum += difference;
    values.push_back(static_cast<std::uint8_t>(std::clamp(sum, 0.0f, 1.0f) * 255 + 0.5f));
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
      const std::vector<float> differences = random_differences(random, columns);
      const auto width = static_cast<int>(columns);
      Mask mask;
      mask.begin(width, 3);

      std::vector<float> all = differences;
      resolve_row(all, mask);

      TouchedColumns touched;
      touched.assign(columns, 1);
      std::vector<std::int32_t> units;
      for (std::size_t i = 0; i < columns; ++i) {
        if (differences[i] != 0) touched.touch(0, i, i);
        units.push_back(static_cast<std::int32_t>(std::lround(differences[i] * 256)));
      }
      std::vector<float> some = differences;
      resolve_row(some, touched.take(0), touched.shift(), mask);
      resolve_row(units, 256, mask);

      const std::vector<std::uint8_t> expected = one_by_one(differences);
      std::vector<std::uint8_t> three;
      for (int i = 0; i < 3; ++i) three.insert(three.end(), expected.begin(), expected.end());
      ASSERT_EQ(testing::values_of(mask), three) << columns;
      ASSERT_TRUE(is_canonical(mask));
      ASSERT_EQ(all, std::vector<float>(columns, 0)) << "they are set to 0";
      ASSERT_EQ(some, all);
      ASSERT_EQ(units, std::vector<std::int32_t>(columns, 0));
    }
  }
}

}  // namespace
}  // namespace trapeze
