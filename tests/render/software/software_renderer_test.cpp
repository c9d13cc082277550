#include "render/software/software_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "tests/render/compare_renderers.h"
#include "tests/render/masks.h"
#include "tests/render/sample_mesh.h"

namespace trapeze {
namespace {

using testing::compare_masks;
using testing::Difference;
using testing::random_scatter;
using testing::random_strips;
using testing::SampleMesh;
using testing::x_at;

Mask draw(const SampleMesh& mesh, const View& view) {
  SoftwareRenderer renderer;
  Mask mask;
  const TrapezoidRange all = mesh.all();
  renderer.draw(mesh.view(), {&all, 1}, view, mask);
  return mask;
}

View square_view(std::int64_t origin, double cells_per_pixel, int pixels) {
  return {origin, origin, cells_per_pixel, pixels, pixels};
}

int value_of(double area) {
  return static_cast<int>(std::floor(area * 255 + 0.5));
}

// The covered share of pixels, computed differently: rows of 1/32 cell, in each of which every
// trapezoid is an interval of x. The y of a vertex is a whole number of cells, so no trapezoid
// begins or ends within such a row.
std::vector<double> shares_by_rows(const MeshView& mesh, const View& view) {
  std::vector<double> sums(static_cast<std::size_t>(view.width * view.height), 0.0);
  constexpr int kRowsPerCell = 32;
  for (const MeshTrapezoid& t : mesh.trapezoids) {
    const std::int64_t top = std::max<std::int64_t>(mesh.vertices[t.top].y, view.origin_y);
    const std::int64_t bottom =
        std::min<std::int64_t>(mesh.vertices[t.bottom].y,
                               view.origin_y + std::llround(view.height * view.cells_per_pixel));
    for (std::int64_t i = top * kRowsPerCell; i < bottom * kRowsPerCell; ++i) {
      const long double y = (static_cast<long double>(i) + 0.5L) / kRowsPerCell;
      const auto to_pixels = [&](long double cells, std::int64_t origin) {
        return static_cast<double>((cells - origin) / view.cells_per_pixel);
      };
      const int row = static_cast<int>(to_pixels(y, view.origin_y));
      const double left = std::max(to_pixels(x_at(mesh, t.left, y), view.origin_x), 0.0);
      const double right =
          std::min<double>(to_pixels(x_at(mesh, t.right, y), view.origin_x), view.width);
      const double height = 1.0 / (kRowsPerCell * view.cells_per_pixel);
      for (int column = static_cast<int>(left); column < right; ++column) {
        const double width = std::min(right, column + 1.0) - std::max(left, double(column));
        sums[static_cast<std::size_t>(row * view.width + column)] += width * height;
      }
    }
  }
  return sums;
}

TEST(SoftwareRendererTest, CoversPixelsOfABoxByTheirSharesExactly) {
  SampleMesh mesh;
  mesh.add_box(10, 4, 38, 24);  // in pixels of 16 cells: 0.625..2.375 by 0.25..1.5
  const Mask mask = draw(mesh, square_view(0, 16, 4));
  const double columns[] = {0.375, 1, 0.375, 0};
  const double rows[] = {0.75, 0.5, 0, 0};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      EXPECT_EQ(mask.at(column, row), value_of(columns[column] * rows[row]))
          << column << ", " << row;
    }
  }
}

TEST(SoftwareRendererTest, ABoxWithItsEdgesChangedRoundTakesAreaAway) {
  SampleMesh mesh;
  mesh.add_box(-16, -16, 80, 80);
  // Two columns of holes across the west and the east border, a quarter of a pixel wide inside, and
  // a hole half a pixel wide inside.
  for (const auto& [west, east] : {std::pair{-8, 4}, std::pair{60, 72}, std::pair{24, 32}}) {
    mesh.add(mesh.add_edge({east, 0}, {east, 16}), mesh.add_edge({west, 0}, {west, 16}), 0, 16);
  }
  const Mask mask = draw(mesh, square_view(0, 16, 4));
  const double first_row[] = {0.75, 0.5, 1, 0.75};
  for (int column = 0; column < 4; ++column) {
    EXPECT_EQ(mask.at(column, 0), value_of(first_row[column])) << column;
    EXPECT_EQ(mask.at(column, 1), 255) << column;
  }
}

TEST(SoftwareRendererTest, HalvesThePixelsOnADiagonal) {
  SampleMesh mesh;
  const std::uint32_t left = mesh.add_edge({0, 0}, {0, 64});
  mesh.add(left, mesh.add_edge({0, 0}, {64, 64}), 0, 64);
  const Mask mask = draw(mesh, square_view(0, 8, 8));
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) {
      EXPECT_EQ(mask.at(column, row), column < row ? 255 : column == row ? 128 : 0);
    }
  }
}

TEST(SoftwareRendererTest, StretchedPixelsShowWhatIsOnTheirGround) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const SampleMesh mesh = testing::random_strips(random, {0, 0, 4096, 4096}, 50);
  View view{0, 0, 64, 64, 32};
  view.stretch = 2;
  const Mask stretched = draw(mesh, view);
  const Mask fine = draw(mesh, {0, 0, 64, 64, 64});
  for (int row = 0; row < 32; ++row) {
    for (int column = 0; column < 64; ++column) {
      EXPECT_NEAR(stretched.at(column, row),
                  (fine.at(column, 2 * row) + fine.at(column, 2 * row + 1)) / 2.0, 1.01);
    }
  }
}

TEST(SoftwareRendererTest, ABandHasTheRowsOfTheWhole) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const SampleMesh mesh = testing::random_strips(random, {0, 0, 10'000, 10'000}, 500);
  View view{-123, 77, 100.0 / 3, 300, 290};
  view.stretch = 0.9;
  const Mask whole = draw(mesh, view);
  for (const int first : {0, 1, 100, 289}) {
    const int rows = std::min(64, view.height - first);
    const Mask band = draw(mesh, view.band(first, rows));
    ASSERT_EQ(band.height(), rows);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < view.width; ++column) {
        EXPECT_NEAR(band.at(column, row), whole.at(column, first + row), 1);
      }
    }
  }
}

TEST(SoftwareRendererTest, LeavesThePictureEmptyWhereNothingIsDrawn) {
  EXPECT_TRUE(draw(SampleMesh(), square_view(0, 1, 7)).is_all(0));
  SampleMesh around;
  around.add_box(-50, 0, 0, 10);
  around.add_box(10, 0, 50, 10);
  around.add_box(0, -50, 10, 0);
  around.add_box(0, 10, 10, 50);
  EXPECT_TRUE(draw(around, square_view(0, 1, 10)).is_all(0));
}

TEST(SoftwareRendererTest, FillsThePictureInsideOfAHugeTrapezoid) {
  SampleMesh mesh;
  const std::uint32_t left = mesh.add_edge({kGridMin + 5, kGridMin}, {kGridMin, kGridMax});
  mesh.add(left, mesh.add_edge({kGridMax - 5, kGridMin}, {kGridMax, kGridMax}), kGridMin, kGridMax);
  EXPECT_TRUE(draw(mesh, View::of_tile({22, 2'000'000, 2'000'000})).is_all(255));
  EXPECT_TRUE(draw(mesh, View::of_tile({0, 0, 0})).is_all(255));
}

TEST(SoftwareRendererTest, DrawsNothingForTrapezoidsWithoutHeight) {
  SampleMesh mesh;
  const std::uint32_t left = mesh.add_edge({0, 0}, {0, 64});
  const std::uint32_t right = mesh.add_edge({64, 0}, {64, 64});
  mesh.add(left, right, 30, 30);
  const std::uint32_t horizontal_edge = mesh.add_edge({0, 30}, {64, 30});
  mesh.add(horizontal_edge, horizontal_edge, 30, 30);
  EXPECT_TRUE(draw(mesh, square_view(0, 8, 8)).is_all(0));
}

TEST(SoftwareRendererTest, StopsAtAWholePixelWherePolygonsOverlap) {
  SampleMesh mesh;
  for (int i = 0; i < 3; ++i) mesh.add_box(0, 0, 6, 8);
  const Mask mask = draw(mesh, square_view(0, 8, 1));
  EXPECT_EQ(mask.at(0, 0), 255);
  SampleMesh twice;
  twice.add_box(0, 0, 3, 8);
  twice.add_box(0, 0, 3, 8);
  EXPECT_EQ(draw(twice, square_view(0, 8, 1)).at(0, 0), value_of(0.75));
}

TEST(SoftwareRendererTest, SumsAHundredThousandTrapezoidsWithinOnePixel) {
  SampleMesh mesh;
  for (std::int32_t i = 0; i < 100'000; ++i) mesh.add_box(0, 2 * i, 1 << 17, 2 * i + 1);
  const double area = 100'000.0 * (1 << 17) / (262144.0 * 262144.0);
  const Mask mask = draw(mesh, square_view(0, 262144, 1));
  // Half a value for rounding; each height is half a unit, rounded at random: three times the
  // standard deviation of 100,000 of these is 0.93.
  EXPECT_NEAR(mask.at(0, 0), area * 255, 0.5 + 0.93);
}

TEST(SoftwareRendererTest, AMaskDoesNotDependOnTheOrderOfTrapezoids) {
  std::mt19937 random(7);
  const View view = square_view(1000, 16, 24);
  for (const int count : {90, 40'000}) {  // also with sums that exceed 32 bits
    const SampleMesh mesh = random_scatter(random, Box{-3000, 0, 4000, 2600}, count);
    const TrapezoidRange all = mesh.all();
    Mask in_order;
    SoftwareRenderer().draw(mesh.view(), {&all, 1}, view, in_order);
    MeshView shuffled = mesh.view();
    std::vector<MeshTrapezoid> trapezoids(shuffled.trapezoids.begin(), shuffled.trapezoids.end());
    std::ranges::shuffle(trapezoids, random);
    shuffled.trapezoids = trapezoids;
    Mask in_another;
    SoftwareRenderer().draw(shuffled, {&all, 1}, view, in_another);
    ASSERT_EQ(in_another, in_order) << count;
  }
}

TEST(SoftwareRendererTest, AMaskDoesNotDependOnHowSidesAreCut) {
  // A box that extends far beyond the picture, whole and cut at a row that is not on a pixel
  // border.
  SampleMesh whole;
  whole.add_box(-5000, -700, 90'000, 1234);
  SampleMesh cut;
  cut.add_box(-5000, -700, 90'000, 333);
  cut.add_box(-5000, 333, 90'000, 335);
  cut.add_box(-5000, 335, 90'000, 1234);
  const View view = square_view(0, 16, 100);
  EXPECT_EQ(draw(whole, view), draw(cut, view));
}

TEST(SoftwareRendererTest, AgreesWithSummingRows) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  const View view = square_view(1000, 16, 24);
  for (int i = 0; i < 40; ++i) {
    const Box box = i % 2 == 0 ? Box{1010, 1005, 1380, 1390} : Box{-3000, 0, 4000, 2600};
    const SampleMesh mesh =
        i % 4 < 2 ? random_strips(random, box, 10 << (i % 5)) : random_scatter(random, box, 90);
    const std::vector<double> expected = shares_by_rows(mesh.view(), view);
    const std::vector<std::uint8_t> actual = testing::values_of(draw(mesh, view));
    for (std::size_t p = 0; p < expected.size(); ++p) {
      // Half a value for rounding, and the loss of horizontal edges within a row.
      ASSERT_NEAR(actual[p], expected[p] * 255, 0.5 + 0.5) << "mesh " << i << ", pixel " << p;
    }
  }
}

TEST(SoftwareRendererTest, CoversExactlyTheAreaOfTheMesh) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (int i = 0; i < 20; ++i) {
    const SampleMesh mesh = random_strips(random, {3, 5, 8001, 7003}, 200);
    const View view = square_view(0, 32, 256);
    const Mask mask = draw(mesh, view);
    const auto drawn = testing::values_of(mask);
    const double sum = std::accumulate(drawn.begin(), drawn.end(), 0.0);
    const double area = static_cast<double>(mesh.area()) / (32 * 32);
    // Rounding to whole values is a random walk with at most half a value a pixel.
    EXPECT_NEAR(sum / 255, area, 4 * 0.3 / 255 * 256);
  }
}

// The area to the right of an edge that crosses the picture from above to below, summed in rows, a
// thousand to a pixel.
double share_right_of(const MeshView& mesh, std::uint32_t edge, const View& view, int column,
                      int row) {
  constexpr int kRows = 1000;
  const Point bottom = mesh.vertices[mesh.edges[edge].lower];
  const Point top = mesh.vertices[mesh.edges[edge].upper];
  double sum = 0;
  for (int i = 0; i < kRows; ++i) {
    const long double y = view.origin_y + (row + (i + 0.5L) / kRows) * view.cells_per_pixel;
    if (y < top.y || y > bottom.y) continue;
    const long double x = (x_at(mesh, edge, y) - view.origin_x) / view.cells_per_pixel;
    sum += static_cast<double>(1 - std::clamp(x - column, 0.0L, 1.0L));
  }
  return sum / kRows;
}

TEST(SoftwareRendererTest, PlacesAnEdgeAcrossTheWorldToAThousandthOfAPixel) {
  const struct {
    Point upper, lower;
  } edges[] = {{{-3, kGridMin + 700'000'001}, {4, kGridMax}},     // steep
               {{kGridMax - 5, kGridMin}, {kGridMin, kGridMax}},  // slanted
               {{kGridMin + 700'000'001, -3}, {kGridMax, 4}}};    // shallow
  for (const auto& [upper, lower] : edges) {
    SampleMesh mesh;
    const std::uint32_t left = mesh.add_edge(upper, lower);
    const std::uint32_t right = mesh.add_edge({kGridMax, upper.y}, {kGridMax, lower.y});
    mesh.add(left, right, upper.y, lower.y);
    // A value is 1/255 of a pixel, and a pixel is 1/100 of a cell here: 2.5 / 100,000 of a pixel of
    // zoom 22. Every edge crosses the picture, which is a cell wide and high.
    const View view{static_cast<std::int64_t>(std::floor(x_at(mesh.view(), left, 0.3737L))), 0,
                    0.01, 100, 100};
    const Mask mask = draw(mesh, view);
    int between = 0;
    for (int row = 0; row < 100; ++row) {
      for (int column = 0; column < 100; ++column) {
        const int actual = mask.at(column, row);
        between += actual > 0 && actual < 255 ? 1 : 0;
        ASSERT_NEAR(actual, 255 * share_right_of(mesh.view(), left, view, column, row), 1.0)
            << column << ", " << row;
      }
    }
    EXPECT_GE(between, 50) << "the edge was to pass the picture";
  }
}

TEST(SoftwareRendererTest, NeighbouringPicturesPutTogetherEqualOneLargePicture) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (int i = 0; i < 10; ++i) {
    const SampleMesh mesh = random_strips(random, {-5000, -4000, 9000, 8000}, 300);
    const Mask large = draw(mesh, square_view(0, 16, 256));
    for (int quarter = 0; quarter < 4; ++quarter) {
      const int column = quarter % 2 * 128;
      const int row = quarter / 2 * 128;
      const Mask small = draw(mesh, {column * 16, row * 16, 16, 128, 128});
      for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 128; ++x) {
          ASSERT_LE(std::abs(small.at(x, y) - large.at(column + x, row + y)), 1);
        }
      }
    }
  }
}

TEST(SoftwareRendererTest, LeavesNothingBehindForTheNextPicture) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  SoftwareRenderer used;
  for (int i = 0; i < 20; ++i) {
    const SampleMesh mesh = random_strips(random, {-3000, -3000, 6000, 6000}, 100);
    const View view = square_view(i * 10, 16, 100 + i % 3);
    const TrapezoidRange all = mesh.all();
    Mask mask;
    used.draw(mesh.view(), {&all, 1}, view, mask);
    ASSERT_EQ(mask, draw(mesh, view));
  }
}

TEST(SoftwareRendererTest, DrawsSeveralMeshesAsIfTheyWereOne) {
  SampleMesh west;
  west.add_box(0, 0, 3, 8);
  SampleMesh east;
  east.add_box(3, 0, 6, 8);
  const TrapezoidRange one{0, 1};
  const MeshPart parts[] = {{west.view(), {&one, 1}}, {east.view(), {&one, 1}}};
  SoftwareRenderer renderer;
  Mask mask;
  renderer.draw(parts, square_view(0, 8, 1), mask);
  EXPECT_EQ(mask.at(0, 0), value_of(0.75));
}

TEST(SoftwareRendererTest, DrawsOnlyTheRangesNamed) {
  SampleMesh mesh;
  for (std::int32_t i = 0; i < 8; ++i) mesh.add_box(i, 0, i + 1, 1);
  const std::vector<TrapezoidRange> ranges{{1, 2}, {6, 1}, {7, 0}};
  SoftwareRenderer renderer;
  Mask mask;
  renderer.draw(mesh.view(), ranges, {0, 0, 1, 8, 1}, mask);
  EXPECT_EQ(testing::values_of(mask), (std::vector<std::uint8_t>{0, 255, 255, 0, 0, 0, 255, 0}));
}

}  // namespace
}  // namespace trapeze
