#include "render/mask/shared_pixels.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <map>
#include <vector>

namespace trapeze {
namespace {

double share_of(std::uint64_t samples) {
  return std::popcount(samples) / 64.0;
}

/// The directions of the table and their unit vectors.
template <typename Act>
void for_each_direction(const Act& act) {
  for (unsigned direction = 0; direction < HalfPlanes::kDirections; ++direction) {
    const double angle = 2 * M_PI * direction / HalfPlanes::kDirections;
    act(direction, std::cos(angle), std::sin(angle));
  }
}

TEST(HalfPlanesTest, DirectionsAreThoseOfTheTable) {
  for_each_direction([](unsigned direction, double dx, double dy) {
    for (const double length : {1e-9, 1.0, 1e6}) {
      EXPECT_EQ(HalfPlanes::direction_of(length * dx, length * dy), direction);
    }
  });
  EXPECT_EQ(HalfPlanes::direction_of(0, 1), HalfPlanes::kRightAngle);
  EXPECT_EQ(HalfPlanes::direction_of(0, -1), 3 * HalfPlanes::kRightAngle);
}

TEST(HalfPlanesTest, HoldTheirShareOfThePixel) {
  const HalfPlanes& table = HalfPlanes::table();
  for_each_direction([&table](unsigned direction, double dx, double dy) {
    for (float offset = -1; offset <= 1; offset += 1.0f / 16) {
      int within = 0;
      for (int point = 0; point < 64 * 64; ++point) {
        const double x = (point % 64 + 0.5) / 64 - 0.5;
        const double y = (point / 64 + 0.5) / 64 - 0.5;
        within += x * dx + y * dy <= offset;
      }
      const std::uint64_t samples = table.within(direction, offset);
      EXPECT_NEAR(share_of(samples), within / 4096.0, 0.04) << direction << " " << offset;
      EXPECT_EQ(samples, table.within(direction + HalfPlanes::kDirections, offset)) << "a turn";
    }
    EXPECT_EQ(table.within(direction, 0.72f), ~std::uint64_t{0});
    EXPECT_EQ(table.within(direction, -0.72f), 0u);
    EXPECT_EQ(table.within(direction, 1e30f), ~std::uint64_t{0});
    EXPECT_EQ(table.within(direction, -1e30f), 0u);
  });
}

/// What a line from a place on covers of the pixel around another place.
std::uint64_t samples_around(double x, double y, double from_x, double from_y, double dx, double dy,
                             double length, double half, bool has_round_ends) {
  const SampledLine line{static_cast<float>(from_x - x),   static_cast<float>(from_y - y),
                         static_cast<float>(dx),           static_cast<float>(dy),
                         HalfPlanes::direction_of(dx, dy), static_cast<float>(length),
                         static_cast<float>(half),         has_round_ends};
  return line.samples(HalfPlanes::table());
}

TEST(SampledLineTest, CoversAsMuchAsItsWidthInAnyDirection) {
  for_each_direction([](unsigned, double dx, double dy) {
    const auto share_around = [&](double x, double y) {
      return share_of(samples_around(x, y, 10 - 5 * dx, 10 - 5 * dy, dx, dy, 10, 0.2, false));
    };
    // A pixel is between one and the root of two long along the line.
    EXPECT_GE(share_around(10, 10), 0.4 - 0.06);
    EXPECT_LE(share_around(10, 10), 0.4 * std::sqrt(2) + 0.06);
    EXPECT_EQ(share_around(10 - dy, 10 + dx), 0) << "beside it";
    EXPECT_EQ(share_around(10 + 6 * dx, 10 + 6 * dy), 0) << "beyond its end";
    EXPECT_EQ(share_around(10 - 6 * dx, 10 - 6 * dy), 0) << "before its beginning";
  });
}

TEST(SampledLineTest, RoundEndsAreDiscs) {
  for (const double half : {0.5, 1.0, 4.0}) {
    double sum = 0;
    for (int row = 0; row < 12; ++row) {
      for (int column = 0; column < 12; ++column) {
        sum += share_of(samples_around(column + 0.5, row + 0.5, 6.3, 5.8, 1, 0, 1e-6, half, true));
      }
    }
    EXPECT_NEAR(sum, M_PI * half * half, 0.12 * M_PI * half * half) << half;
  }
}

TEST(SharedPixelsTest, CoverWhatTheirLinesDoInAnyOrder) {
  constexpr std::uint64_t kHalf = 0x00000000ffffffff;
  const std::map<std::uint32_t, std::uint64_t> samples = {
      {1, kHalf}, {2, ~kHalf << 16}, {3, kHalf << 8}};
  const std::map<std::uint32_t, std::uint8_t> inks = {{1, 255}, {2, 255}, {3, 102}};
  SharedPixels pixels;
  const auto drawn = [&](const std::vector<std::uint32_t>& numbers) {
    pixels.begin(10);
    for (const std::uint32_t number : numbers) {
      if (pixels.known()[7] == 0) {
        pixels.known()[7] = number;
        continue;
      }
      pixels.add(
          7, number, [&](std::uint32_t of) { return samples.at(of); },
          [&](std::uint32_t of) { return inks.at(of); });
    }
    std::vector<int> values;
    pixels.for_each([&](std::size_t place, std::uint8_t value) {
      EXPECT_EQ(place, 7u);
      values.push_back(value);
    });
    pixels.forget(0, 10);
    pixels.finish();
    return values;
  };
  EXPECT_EQ(drawn({}), std::vector<int>{});
  EXPECT_EQ(drawn({2}), std::vector<int>{}) << "a line alone";
  EXPECT_EQ(drawn({1, 1}), std::vector<int>{}) << "the same twice is not more than once";
  EXPECT_EQ(drawn({1, 2}), std::vector<int>{(47 * 255 + 32) / 64});
  EXPECT_EQ(drawn({2, 1}), drawn({1, 2}));
  EXPECT_EQ(drawn({1, 3}), std::vector<int>{(39 * 102 + 32) / 64}) << "the least ink";
  EXPECT_EQ(drawn({3, 2, 1}), drawn({1, 2, 3}));
  EXPECT_EQ(drawn({2, 3, 1}), drawn({1, 2, 3}));
}

}  // namespace
}  // namespace trapeze
