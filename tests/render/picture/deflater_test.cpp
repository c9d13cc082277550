#include "render/picture/deflater.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

namespace trapeze {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes compressed(Deflater& deflater, const Bytes& input) {
  const auto output = deflater.compress(input);
  return {output.begin(), output.end()};
}

// Rows of a picture that are equal, each of which begins with bytes that are rare in it.
Bytes equal_rows(std::mt19937& random) {
  Bytes row(33, static_cast<std::uint8_t>(random()));
  for (std::size_t i = 0; i < 6; ++i) row[i] = static_cast<std::uint8_t>(random());
  Bytes rows;
  for (int i = 0; i < 40; ++i) rows.insert(rows.end(), row.begin(), row.end());
  return rows;
}

TEST(DeflaterTest, WhatIsCompressedComesBack) {
  std::mt19937 random(1);
  Deflater deflater;
  for (const std::size_t size : {0, 1, 7, 300, 5000, 70000, 300000}) {
    Bytes input(size);
    for (std::uint8_t& byte : input) byte = static_cast<std::uint8_t>(random() % 3);
    const Bytes output = compressed(deflater, input);
    Bytes back(size + 1);
    uLongf length = back.size();
    ASSERT_EQ(uncompress(back.data(), &length, output.data(), output.size()), Z_OK) << size;
    back.resize(length);
    EXPECT_EQ(back, input);
  }
}

TEST(DeflaterTest, EqualInputsHaveEqualBytesWhereverTheMemoryLies) {
  std::mt19937 random(1);
  std::vector<Deflater> deflaters(40);
  int different = 0;
  for (int i = 0; i < 2000; ++i) {
    const Bytes input = equal_rows(random);
    const Bytes expected = compressed(deflaters.front(), input);
    different += !std::ranges::all_of(
        deflaters, [&](Deflater& deflater) { return compressed(deflater, input) == expected; });
  }
  EXPECT_EQ(different, 0);
}

TEST(DeflaterTest, EqualInputsHaveEqualBytesWhateverTheMemoryHeld) {
  const Bytes input = [] {
    std::mt19937 random(1);
    return equal_rows(random);
  }();
  Deflater fresh;
  const Bytes expected = compressed(fresh, input);
  Deflater used;
  std::mt19937 random(2);
  for (std::size_t size = 1; size < 200'000; size *= 3) {
    Bytes other(size);
    for (std::uint8_t& byte : other) byte = static_cast<std::uint8_t>(random() % 5);
    compressed(used, other);
    EXPECT_EQ(compressed(used, input), expected) << size;
  }
}

}  // namespace
}  // namespace trapeze
