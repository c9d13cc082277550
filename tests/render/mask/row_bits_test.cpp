#include "render/mask/row_bits.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace trapeze {
namespace {

bool is_set(const std::vector<std::uint64_t>& bits, std::size_t i) {
  return (bits[i / 64] >> i % 64 & 1) != 0;
}

TEST(RowBitsTest, AreThoseOfEveryPixelByItself) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (const std::size_t width : {1u, 7u, 16u, 17u, 63u, 64u, 65u, 256u, 300u}) {
    for (int round = 0; round < 20; ++round) {
      std::vector<std::uint8_t> values;
      while (values.size() < width) {
        const std::size_t length = 1 + random() % 40;
        const auto value = static_cast<std::uint8_t>(random() % 3 == 0   ? 0
                                                     : random() % 3 == 1 ? 255
                                                                         : random());
        values.resize(std::min(width, values.size() + length), value);
      }
      std::vector<std::uint64_t> changes(words_for(width), 0);
      std::vector<std::uint64_t> covered(words_for(width), 0);
      std::vector<std::uint64_t> partial(words_for(width), 0);
      const bool has_changes = mark_changes(values, changes);
      const bool has_covered = mark_covered(values, covered);
      const bool has_partial = mark_partial(values, partial);
      bool any_change = false;
      bool any_covered = false;
      bool any_partial = false;
      for (std::size_t i = 0; i < width; ++i) {
        const bool changes_here = i > 0 && values[i] != values[i - 1];
        EXPECT_EQ(is_set(changes, i), changes_here) << i << " of " << width;
        EXPECT_EQ(is_set(covered, i), values[i] != 0) << i << " of " << width;
        any_change = any_change || changes_here;
        any_covered = any_covered || values[i] != 0;
        const bool is_partial = values[i] != 0 && values[i] != 255;
        EXPECT_EQ(is_set(partial, i), is_partial) << i << " of " << width;
        any_partial = any_partial || is_partial;
      }
      EXPECT_EQ(has_changes, any_change);
      EXPECT_EQ(has_covered, any_covered);
      EXPECT_EQ(has_partial, any_partial);
    }
  }
}

TEST(RowBitsTest, BitsThatAreSetRemainSet) {
  const std::vector<std::uint8_t> values(100, 9);
  std::vector<std::uint64_t> bits{5, 6};
  EXPECT_FALSE(mark_changes(values, bits));
  EXPECT_EQ(bits, (std::vector<std::uint64_t>{5, 6}));
}

}  // namespace
}  // namespace trapeze
