#include "render/picture/pattern.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "tests/render/masks.h"

namespace trapeze {
namespace {

Mask draw(const Pattern& pattern, View view = View::of_tile({3, 2, 5}), int scale = 1) {
  PlacedPattern placed;
  placed.place(pattern, view, scale);
  std::vector<std::uint8_t> values(static_cast<std::size_t>(view.width));
  return testing::mask_by(view.width, view.height, [&](int column, int row) {
    if (column == 0) placed.draw(row, 0, values.size(), values.data());
    return values[static_cast<std::size_t>(column)];
  });
}

/// The share of the picture that is covered.
double density(const Mask& mask) {
  const auto pixels = testing::values_of(mask);
  return std::accumulate(pixels.begin(), pixels.end(), 0.0) / 255 /
         static_cast<double>(pixels.size());
}

double share(PatternKind kind, double size, double angle, double width) {
  Pattern pattern;
  pattern.kind = kind;
  pattern.size = size;
  pattern.angle = angle;
  pattern.width = width;
  return density(draw(pattern));
}

TEST(PatternTest, CoversTheShareThatItsLengthsSay) {
  EXPECT_EQ(share(PatternKind::none, 8, 0, 1), 0);
  for (const double angle : {0.0, 45.0, 17.0}) {
    EXPECT_NEAR(share(PatternKind::hatch, 8, angle, 1), 1.0 / 8, 0.004) << angle;
    EXPECT_NEAR(share(PatternKind::hatch, 8, angle, 0.25), 0.25 / 8, 0.004) << angle;
    EXPECT_NEAR(share(PatternKind::stripes, 10, angle, 5), 0.5, 0.01) << angle;
    EXPECT_NEAR(share(PatternKind::crosshatch, 16, angle, 2), 1 - std::pow(14.0 / 16, 2), 0.015);
    EXPECT_NEAR(share(PatternKind::checker, 16, angle, 1), 0.5, 0.01) << angle;
    EXPECT_NEAR(share(PatternKind::dots, 12, angle, 6), M_PI * 9 / 144, 0.01) << angle;
  }
  EXPECT_EQ(share(PatternKind::hatch, 2, 30, 64), 1);
}

TEST(PatternTest, LinesRunInTheDirectionOfTheAngle) {
  const Mask east = draw({PatternKind::hatch, {}, 8, 0, 2});
  for (int row = 0; row < 256; ++row) {
    for (int column = 1; column < 256; ++column) {
      ASSERT_EQ(east.at(column, row), east.at(0, row)) << column << " " << row;
    }
  }
  // Anticlockwise from east: one step east and one step north stay on the line.
  const Mask north_east = draw({PatternKind::hatch, {}, 8, 45, 2});
  for (int row = 1; row < 256; ++row) {
    for (int column = 0; column < 255; ++column) {
      ASSERT_NEAR(north_east.at(column, row), north_east.at(column + 1, row - 1), 1);
    }
  }
}

TEST(PatternTest, GoesOnOverTheAntimeridian) {
  for (const PatternKind kind : {PatternKind::checker, PatternKind::crosshatch, PatternKind::dots,
                                 PatternKind::hatch, PatternKind::stripes}) {
    for (const double size : {5.0, 13.0, 64.0}) {
      for (const double angle : {0.0, 45.0, 100.0}) {
        for (const auto& [zoom, scale] : {std::pair(0, 1), {0, 3}, {4, 1}, {22, 2}}) {
          const Pattern pattern{kind, {}, size, angle, 4};
          const std::uint32_t tiles = 1u << zoom;
          // Over both ends of the world, as windows of the map are.
          View over = View::of_tile({zoom, tiles - 1, 0}, scale);
          View beyond = View::of_tile({zoom, 0, 0}, scale);
          over.origin_x += static_cast<std::int64_t>(100 * over.cells_per_pixel);
          beyond.origin_x += static_cast<std::int64_t>(100 * over.cells_per_pixel);
          beyond.origin_x -= kGridSize / tiles;
          const Mask east = draw(pattern, over, scale);
          const Mask west = draw(pattern, beyond, scale);
          for (int row = 0; row < over.height; row += 7) {
            for (int column = 0; column < over.width; ++column) {
              // Within a step of what is looked up.
              ASSERT_NEAR(east.at(column, row), west.at(column, row), 4)
                  << "kind " << static_cast<int>(kind) << " size " << size << " angle " << angle
                  << " zoom " << zoom;
            }
          }
        }
      }
    }
  }
}

TEST(PatternTest, WhereTheWorldDoesNotRepeatPatternsHaveTheirSize) {
  View plane = View::of_tile({0, 0, 0});
  plane.projection = Projection::plane;
  const Mask mask = draw({PatternKind::hatch, {}, 20, 90, 1}, plane);
  for (int column = 0; column < 236; ++column) {
    ASSERT_NEAR(mask.at(column, 3), mask.at(column + 20, 3), 1) << column;
  }
  EXPECT_GT(mask.at(0, 3), 100);
  EXPECT_EQ(mask.at(10, 3), 0);
}

TEST(PatternTest, NeighbouringTilesJoin) {
  for (const PatternKind kind : {PatternKind::checker, PatternKind::crosshatch, PatternKind::dots,
                                 PatternKind::hatch, PatternKind::stripes}) {
    for (const int zoom : {3, 22}) {
      const Pattern pattern{kind, {}, 13, 30, 4};
      const std::uint32_t x = (1u << zoom) / 3;
      const View tile = View::of_tile({zoom, x, 1});
      View both = tile;
      both.width = 512;
      const Mask west = draw(pattern, tile);
      const Mask east = draw(pattern, View::of_tile({zoom, x + 1, 1}));
      const Mask whole = draw(pattern, both);
      for (int row = 0; row < 256; row += 5) {
        for (int column = 0; column < 256; ++column) {
          ASSERT_NEAR(west.at(column, row), whole.at(column, row), 1);
          ASSERT_NEAR(east.at(column, row), whole.at(column + 256, row), 1);
        }
      }
    }
  }
}

// The sides of windows are rounded to cells, so that their pixels are not all of the same size.
TEST(PatternTest, NeighbouringWindowsOfAnySizeOfPixelsJoin) {
  constexpr double kCellsOfPixel = 1217.748;  // in cells: zoom 12.75
  const auto window = [](int column, int row) {
    const auto side = [](int i) { return std::llround(i * 256 * kCellsOfPixel); };
    View view;
    view.width = view.height = 256;
    view.origin_x = kGridMin + side(6000 + column);
    view.origin_y = kGridMin + side(4000 + row);
    view.cells_per_pixel = static_cast<double>(side(6001 + column) - side(6000 + column)) / 256;
    const double high = static_cast<double>(side(4001 + row) - side(4000 + row)) / 256;
    view.stretch = high / view.cells_per_pixel;
    return view;
  };
  for (const PatternKind kind : {PatternKind::hatch, PatternKind::checker, PatternKind::dots}) {
    const Pattern pattern{kind, {}, 16, 30, 8};
    for (int i = 0; i < 8; ++i) {
      // The columns of the world are a whole number of periods apart, but for a share of a pixel.
      View moved = window(0, 0);
      const View there = window(i, i);
      moved.origin_x = there.origin_x;
      moved.origin_y = there.origin_y;
      const Mask here = draw(pattern, moved);
      const Mask next = draw(pattern, there);
      for (int k = 0; k < 256; ++k) ASSERT_NEAR(here.at(k, k), next.at(k, k), 8) << i << " " << k;
    }
  }
}

TEST(PatternTest, LengthsGrowWithTheScale) {
  const Pattern pattern{PatternKind::dots, {}, 12, 0, 5};
  const Mask one = draw(pattern);
  const Mask four = draw(pattern, View::of_tile({3, 2, 5}, 4), 4);
  EXPECT_NEAR(density(one), density(four), 0.01);
  EXPECT_EQ(four.width(), 1024);
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      double sum = 0;
      for (int k = 0; k < 16; ++k) sum += four.at(4 * column + k % 4, 4 * row + k / 4);
      ASSERT_NEAR(one.at(column, row), sum / 16, 40) << column << " " << row;
    }
  }
}

}  // namespace
}  // namespace trapeze
