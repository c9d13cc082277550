#include "render/mask/row_bits.h"

#include <gtest/gtest.h>

#include <random>
#include <utility>
#include <vector>

#include "tests/render/masks.h"

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
      const Mask mask = testing::mask_by(static_cast<int>(width), 1, [&](int column, int) {
        return values[static_cast<std::size_t>(column)];
      });
      mark_changes(mask.row(0), changes);
      mark_covered(mask.row(0), covered);
      const bool has_partial = mark_partial(mask.row(0), partial);
      bool any_partial = false;
      for (std::size_t i = 0; i < width; ++i) {
        const bool changes_here = i > 0 && values[i] != values[i - 1];
        EXPECT_EQ(is_set(changes, i), changes_here) << i << " of " << width;
        EXPECT_EQ(is_set(covered, i), values[i] != 0) << i << " of " << width;
        const bool is_partial = values[i] != 0 && values[i] != 255;
        EXPECT_EQ(is_set(partial, i), is_partial) << i << " of " << width;
        any_partial = any_partial || is_partial;
      }
      EXPECT_EQ(has_partial, any_partial);
    }
  }
}

TEST(RowBitsTest, BitsThatAreSetRemainSet) {
  const Mask mask(100, 1, 9);
  std::vector<std::uint64_t> bits{5, 6};
  mark_changes(mask.row(0), bits);
  EXPECT_FALSE(mark_partial(Mask(100, 1, 255).row(0), bits));
  EXPECT_EQ(bits, (std::vector<std::uint64_t>{5, 6}));
}

TEST(RowBitsTest, RunsOfBitsAreFoundAcrossWords) {
  std::vector<std::uint64_t> bits(4, 0);
  const std::vector<std::pair<std::size_t, std::size_t>> runs{
      {0, 1}, {3, 64}, {65, 193}, {199, 200}};
  for (const auto& [begin, end] : runs) set_bits(begin, end, bits);
  set_bits(210, 220, bits);  // beyond the requested length
  std::vector<std::pair<std::size_t, std::size_t>> found;
  for_each_run_of_bits(bits, 200,
                       [&](std::size_t begin, std::size_t end) { found.emplace_back(begin, end); });
  EXPECT_EQ(found, runs);
  std::vector<std::size_t> set;
  for_each_bit(std::span(bits).first(1), [&](std::size_t i) { set.push_back(i); });
  EXPECT_EQ(set.size(), 62u);
  EXPECT_EQ(set[1], 3u);
}

}  // namespace
}  // namespace trapeze
