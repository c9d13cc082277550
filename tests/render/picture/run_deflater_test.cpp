#include "render/picture/run_deflater.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

namespace trapeze {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Row = std::vector<PixelRun>;

struct Pixels {
  std::uint32_t columns = 1;
  std::uint32_t bytes_per_pixel = 1;
  std::vector<Row> rows;
};

Bytes bytes_of(const Pixels& pixels) {
  Bytes bytes;
  for (const Row& row : pixels.rows) {
    bytes.push_back(0);
    std::uint32_t column = 0;
    for (const PixelRun& run : row) {
      for (; column < run.end; ++column) {
        for (std::uint32_t i = 0; i < pixels.bytes_per_pixel; ++i) {
          bytes.push_back(static_cast<std::uint8_t>(run.pixel >> 8 * i));
        }
      }
    }
  }
  return bytes;
}

Bytes compressed(RunDeflater& deflater, const Pixels& pixels) {
  deflater.begin(pixels.columns, pixels.bytes_per_pixel);
  for (const Row& row : pixels.rows) deflater.add_row(row);
  const auto output = deflater.finish();
  return {output.begin(), output.end()};
}

// Decompresses with zlib, which also verifies the checksum. Empty on any error.
Bytes decompressed(const Bytes& compressed, std::size_t size) {
  Bytes bytes(size + 1);
  uLongf length = bytes.size();
  if (uncompress(bytes.data(), &length, compressed.data(), compressed.size()) != Z_OK) return {};
  bytes.resize(length);
  return bytes;
}

class RandomPixels {
 public:
  explicit RandomPixels(unsigned seed) : random_(seed) {}

  void set_bytes_per_pixel(std::uint32_t bytes) { mask_ = ~0u >> (32 - 8 * bytes); }

  std::uint32_t number(std::uint32_t least, std::uint32_t most) {
    return std::uniform_int_distribution<std::uint32_t>(least, most)(random_);
  }

  Row row(std::uint32_t columns, std::uint32_t longest, std::uint32_t colours) {
    Row row;
    std::uint32_t end = 0;
    while (end < columns) {
      end = std::min(columns, end + number(1, longest));
      row.push_back({end, colour(colours)});
    }
    return row;
  }

  // Rows that are new, equal to the one above, or different from it in a pixel or two.
  Pixels pixels(std::uint32_t columns, std::uint32_t rows) {
    Pixels pixels{columns, std::vector<std::uint32_t>{1, 3, 4}[number(0, 2)], {}};
    set_bytes_per_pixel(pixels.bytes_per_pixel);
    const std::uint32_t longest = number(1, 60);
    const std::uint32_t colours = number(1, 3) == 1 ? 2 : number(2, 70'000);
    for (std::uint32_t i = 0; i < rows; ++i) {
      const bool is_new = pixels.rows.empty() || number(0, 2) == 0;
      pixels.rows.push_back(is_new ? row(columns, longest, colours) : pixels.rows.back());
      if (is_new || number(0, 1) == 0) continue;
      Row& like_above = pixels.rows.back();
      like_above[number(0, static_cast<std::uint32_t>(like_above.size()) - 1)].pixel =
          colour(colours);
    }
    return pixels;
  }

 private:
  std::uint32_t colour(std::uint32_t colours) {
    return (number(0, colours - 1) * 2'654'435'761u) & mask_;
  }

  std::mt19937 random_;
  std::uint32_t mask_ = ~0u;
};

void expect_back(RunDeflater& deflater, const Pixels& pixels) {
  const Bytes bytes = bytes_of(pixels);
  const Bytes output = compressed(deflater, pixels);
  EXPECT_EQ(decompressed(output, bytes.size()), bytes)
      << pixels.columns << " x " << pixels.rows.size() << " pixels of " << pixels.bytes_per_pixel;
}

TEST(RunDeflaterTest, WhatIsCompressedComesBack) {
  RandomPixels random(1);
  RunDeflater deflater;
  for (int i = 0; i < 1500; ++i) {
    expect_back(deflater, random.pixels(random.number(1, 300), random.number(1, 40)));
  }
}

TEST(RunDeflaterTest, RowsLongerThanTheWindowComeBack) {
  RandomPixels random(2);
  RunDeflater deflater;
  for (const std::uint32_t columns : {8'191u, 8'192u, 16'384u}) {
    for (int i = 0; i < 3; ++i) expect_back(deflater, random.pixels(columns, 20));
  }
}

TEST(RunDeflaterTest, ManyBlocksComeBack) {
  RunDeflater deflater;
  for (const std::uint32_t bytes_per_pixel : {1u, 3u, 4u}) {
    RandomPixels random(3);
    random.set_bytes_per_pixel(bytes_per_pixel);
    Pixels pixels{1'024, bytes_per_pixel, {}};
    for (int i = 0; i < 1'024; ++i) pixels.rows.push_back(random.row(1'024, 3, 1'000));
    expect_back(deflater, pixels);
  }
}

// Random pixels of several bytes: not much larger than with zlib, which searches all earlier data.
TEST(RunDeflaterTest, ColoursThatComeAgainAreReferredTo) {
  RunDeflater deflater;
  for (const std::uint32_t bytes_per_pixel : {3u, 4u}) {
    RandomPixels random(5);
    random.set_bytes_per_pixel(bytes_per_pixel);
    Pixels pixels{256, bytes_per_pixel, {}};
    for (int i = 0; i < 256; ++i) pixels.rows.push_back(random.row(256, 4, 500));
    const Bytes bytes = bytes_of(pixels);
    Bytes by_zlib(compressBound(bytes.size()));
    uLongf length = by_zlib.size();
    ASSERT_EQ(compress2(by_zlib.data(), &length, bytes.data(), bytes.size(), 6), Z_OK);
    EXPECT_LT(compressed(deflater, pixels).size(), 1.3 * static_cast<double>(length));
  }
}

// If counts grow like Fibonacci numbers, unlimited codes would be longer than the format allows.
TEST(RunDeflaterTest, CodesAreNoLongerThanTheyMayBe) {
  RunDeflater deflater;
  Row row;
  std::uint32_t count = 1;
  std::uint32_t before = 1;
  std::uint32_t column = 0;
  for (std::uint32_t symbol = 1; symbol < 20; ++symbol) {
    for (std::uint32_t i = 0; i < count; ++i) {
      row.push_back({++column, symbol});
      row.push_back({++column, 0});
    }
    count += std::exchange(before, count);
  }
  expect_back(deflater, {column, 1, {row}});
}

TEST(RunDeflaterTest, APictureOfOneColourTakesNextToNothing) {
  RunDeflater deflater;
  // With 8 bits a pixel, and with 1 bit, which the PNG has.
  const Pixels bytes{256, 1, std::vector<Row>(256, Row{{256, 7}})};
  const Pixels bits{32, 1, std::vector<Row>(256, Row{{32, 0}})};
  expect_back(deflater, bytes);
  expect_back(deflater, bits);
  EXPECT_LT(compressed(deflater, bytes).size(), 320u);
  EXPECT_LT(compressed(deflater, bits).size(), 60u);
}

TEST(RunDeflaterTest, TheBytesDoNotDependOnWhatWasCompressedBefore) {
  RandomPixels random(4);
  RunDeflater used;
  for (int i = 0; i < 100; ++i) {
    const Pixels pixels = random.pixels(random.number(1, 300), random.number(1, 40));
    RunDeflater fresh;
    EXPECT_EQ(compressed(used, pixels), compressed(fresh, pixels));
  }
}

}  // namespace
}  // namespace trapeze
