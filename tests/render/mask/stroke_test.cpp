#include "render/mask/stroke.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <stdexcept>

namespace trapeze {
namespace {

// A pixel is 1024 cells, so that points can be given in fractions of pixels.
constexpr int kCells = 1024;
constexpr int kSide = 100;  // pixels

struct PixelPoint {
  double x;
  double y;
};

Mask draw_edges(const std::vector<PixelPoint>& points, std::vector<OutlineEdge> edges,
                const Stroke& stroke, int scale = 1) {
  View view;
  view.cells_per_pixel = kCells;
  view.width = kSide;
  view.height = kSide;
  std::vector<Point> vertices;
  for (const PixelPoint& p : points) {
    vertices.push_back({static_cast<std::int32_t>(std::lround(p.x * kCells)),
                        static_cast<std::int32_t>(std::lround(p.y * kCells))});
  }
  Mask mask(kSide, kSide);
  mask.fill(0);
  Stroker().draw(vertices, edges, stroke, view, scale, mask);
  return mask;
}

/// A ring, with lengths along it.
Mask draw_ring(const std::vector<PixelPoint>& points, const Stroke& stroke, int scale = 1) {
  std::vector<OutlineEdge> edges;
  double along = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const auto next = static_cast<std::uint32_t>((i + 1) % points.size());
    edges.push_back({i, next, along});
    along += std::hypot(points[next].x - points[i].x, points[next].y - points[i].y) * kCells;
  }
  return draw_edges(points, edges, stroke, scale);
}

/// In pixels.
double area(const Mask& mask) {
  const auto pixels = mask.pixels();
  return std::accumulate(pixels.begin(), pixels.end(), 0.0) / 255;
}

const std::vector<PixelPoint> kSquare = {{20, 20}, {70, 20}, {70, 70}, {20, 70}};

TEST(StrokeTest, ALineIsAsWideAsSaid) {
  for (const double width : {0.25, 1.0, 2.0, 7.5}) {
    for (const double angle : {0.0, 0.3, 1.1, M_PI / 2, 2.5}) {
      const double dx = 30 * std::cos(angle);
      const double dy = 30 * std::sin(angle);
      const Mask mask = draw_edges({{50.3 - dx, 50.4 - dy}, {50.3 + dx, 50.4 + dy}}, {{0, 1, 0}},
                                   {width, {}, LineJoin::round});
      const double ends = M_PI * width * width / 4;
      EXPECT_NEAR(area(mask), 60 * width + ends, 0.03 * 60 * width + 1) << width << " " << angle;
    }
  }
}

TEST(StrokeTest, CornersAreNoDarkerThanTheRest) {
  // The middle of a thin line lies at half its width everywhere, at the corners too.
  const Mask thin = draw_ring({{20.5, 20.5}, {70.5, 20.5}, {70.5, 70.5}, {20.5, 70.5}},
                              {0.5, {}, LineJoin::round});
  int highest = 0;
  for (const std::uint8_t value : thin.pixels()) highest = std::max<int>(highest, value);
  EXPECT_NEAR(highest, 128, 1);
  EXPECT_NEAR(thin.at(45, 20), 128, 1);
  EXPECT_NEAR(thin.at(20, 20), 128, 1);
}

TEST(StrokeTest, JoinsDifferInTheCornerOnly) {
  const auto square = [](LineJoin join) { return draw_ring(kSquare, {8, {}, join}); };
  const Mask miter = square(LineJoin::miter);
  const Mask bevel = square(LineJoin::bevel);
  const Mask round = square(LineJoin::round);
  // Of the corner's square of 4 x 4: all, half, and a quarter of a circle.
  const double sides = 4 * 50 * 8 - 4 * 16;
  EXPECT_NEAR(area(miter), sides + 4 * 16, 2);
  EXPECT_NEAR(area(bevel), sides + 4 * 8, 4);
  EXPECT_NEAR(area(round), sides + 4 * M_PI * 4, 4);
  EXPECT_EQ(miter.at(16, 16), 255);
  EXPECT_EQ(bevel.at(16, 16), 0);
  EXPECT_LT(round.at(16, 16), 128);
  for (int i = 0; i < kSide; ++i) {
    EXPECT_EQ(miter.at(i, 45), bevel.at(i, 45));
    EXPECT_EQ(miter.at(i, 45), round.at(i, 45));
  }
}

TEST(StrokeTest, LongMitersAreCutOff) {
  const std::vector<PixelPoint> needle = {{10, 50}, {60, 48}, {60, 52}};
  const Mask miter = draw_ring(needle, {4, {}, LineJoin::miter});
  const Mask bevel = draw_ring(needle, {4, {}, LineJoin::bevel});
  for (int column = 0; column < 12; ++column) {
    for (int row = 40; row < 60; ++row) {
      EXPECT_EQ(miter.at(column, row), bevel.at(column, row)) << column << " " << row;
    }
  }
}

TEST(StrokeTest, DashesHaveTheirLengths) {
  const Mask dashed = draw_ring(kSquare, {2, {6, 4}, LineJoin::bevel});
  const Mask solid = draw_ring(kSquare, {2, {}, LineJoin::bevel});
  EXPECT_NEAR(area(dashed) / area(solid), 0.6, 0.02);
  // 50 pixels are five dashes of six with gaps of four: from 20 on, on every side.
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(dashed.at(20 + 10 * i + 3, 20), 255) << i;
    EXPECT_EQ(dashed.at(20 + 10 * i + 8, 20), 0) << i;
    EXPECT_EQ(dashed.at(69, 20 + 10 * i + 3), 255) << i;
    EXPECT_EQ(dashed.at(69, 20 + 10 * i + 8), 0) << i;
  }
}

TEST(StrokeTest, NothingIsLeftOpenBetweenManySmallEdges) {
  std::vector<PixelPoint> circle;
  for (int i = 0; i < 700; ++i) {  // edges of a third of a pixel
    const double angle = 2 * M_PI * i / 700;
    circle.push_back({50 + 40 * std::cos(angle), 50 + 40 * std::sin(angle)});
  }
  for (const LineJoin join : {LineJoin::bevel, LineJoin::miter, LineJoin::round}) {
    const Mask mask = draw_ring(circle, {3, {}, join});
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        const double off = std::abs(std::hypot(column + 0.5 - 50, row + 0.5 - 50) - 40);
        const double expected = std::clamp(2 - off, 0.0, 1.0) * 255;
        ASSERT_NEAR(mask.at(column, row), expected, 6) << column << " " << row;
      }
    }
  }
}

TEST(StrokeTest, LengthsGrowWithTheScale) {
  EXPECT_NEAR(area(draw_ring(kSquare, {2, {}, LineJoin::miter}, 2)), 4 * 50 * 4, 2);
  EXPECT_EQ((Stroke{2, {}, LineJoin::round}.reach(3)), 3.5);
  EXPECT_EQ((Stroke{2, {}, LineJoin::miter}.reach(1)), 4.5);
}

TEST(StrokeTest, EdgesFarOffTheViewAreNoTrouble) {
  const Mask mask = draw_edges({{-9e5, 50}, {9e5, 50}, {-9e5, -9e5}, {9e5, -8e5}},
                               {{0, 1, 0}, {2, 3, 0}}, {2, {}, LineJoin::round});
  EXPECT_NEAR(area(mask), 2 * kSide, 0.5);
}

TEST(StrokeTest, LevelsOfAnotherSizeAreRefused) {
  Mask mask(3, 3);
  EXPECT_THROW(Stroker().draw({}, {}, {1, {}, LineJoin::round}, View(), 1, mask),
               std::invalid_argument);
}

}  // namespace
}  // namespace trapeze
