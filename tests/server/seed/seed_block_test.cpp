#include "server/seed/seed_block.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace trapeze {
namespace {

std::vector<std::byte> sample_block() {
  SeedBlockBuilder builder;
  const std::uint64_t sea = builder.add_content("sea", false);
  const std::uint64_t land = builder.add_content("land", false);
  EXPECT_EQ(builder.add_content("sea", false), sea) << "equal bytes are one content";
  builder.add_fingerprint({1, 2}, land);
  builder.add_tiles(3, {0, 4}, sea);
  builder.add_tiles(3, {4, 2}, sea);
  builder.add_tiles(3, {6, 1}, land);
  builder.add_tiles(4, {24, 4}, land);
  builder.figures = {1, 2, 8};
  return builder.bytes(17);
}

TEST(SeedBlockTest, IsReadAsItWasBuilt) {
  const auto bytes = sample_block();
  const auto block = SeedBlock::read(bytes);
  ASSERT_TRUE(block.has_value());
  EXPECT_EQ(block->job(), 17u);
  EXPECT_EQ(block->size(), bytes.size());
  EXPECT_EQ(block->figures().tiles(), 11u);
  const auto entries = block->entries(3);
  ASSERT_EQ(entries.size(), 2u) << "tiles that follow each other are one entry";
  EXPECT_EQ(entries[0].places.count, 6u);
  EXPECT_EQ(block->bytes_of(block->contents()[entries[0].content]), "sea");
  EXPECT_EQ(block->bytes_of(block->contents()[entries[1].content]), "land");
  EXPECT_EQ(block->entries(4).size(), 1u);
  EXPECT_TRUE(block->entries(5).empty());
  ASSERT_EQ(block->fingerprints().size(), 1u);
  EXPECT_EQ(block->fingerprints()[0].fingerprint, (Digest{1, 2}));
}

TEST(SeedBlockTest, IsNotReadIfAnythingOfItIsMissingOrChanged) {
  const auto bytes = sample_block();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(SeedBlock::read(std::span(bytes).first(size)).has_value()) << size;
  }
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto changed = bytes;
    changed[i] ^= std::byte{1};
    EXPECT_FALSE(SeedBlock::read(changed).has_value()) << i;
  }
}

TEST(SeedBlockTest, FindsContentsByTheirFingerprints) {
  SeedBlockBuilder builder;
  builder.add_fingerprint({1, 2}, builder.add_content("land", false));
  EXPECT_EQ(builder.find({1, 2}), 0u);
  EXPECT_FALSE(builder.find({2, 1}).has_value());
}

}  // namespace
}  // namespace trapeze
