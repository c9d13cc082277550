#include "render/mask/stroke.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <random>
#include <stdexcept>

#include "tests/render/masks.h"

namespace trapeze {
namespace {

// A pixel is 1024 cells, so that vertices can be given in fractions of pixels.
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
  Stroker stroker;
  stroker.begin(view, scale);
  stroker.add(vertices, edges);
  stroker.draw(stroke);
  Mask mask;
  stroker.finish(mask);
  return mask;
}

/// Draws a ring with the length along it at every vertex.
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
  const auto pixels = testing::values_of(mask);
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
  // Along the middle of a thin line the opacity is half everywhere, also at the corners.
  const Mask thin = draw_ring({{20.5, 20.5}, {70.5, 20.5}, {70.5, 70.5}, {20.5, 70.5}},
                              {0.5, {}, LineJoin::round});
  int highest = 0;
  for (const std::uint8_t value : testing::values_of(thin)) highest = std::max<int>(highest, value);
  EXPECT_NEAR(highest, 128, 1);
  EXPECT_NEAR(thin.at(45, 20), 128, 1);
  EXPECT_NEAR(thin.at(20, 20), 128, 1);
}

TEST(StrokeTest, JoinsDifferInTheCornerOnly) {
  const auto square = [](LineJoin join) { return draw_ring(kSquare, {8, {}, join}); };
  const Mask miter = square(LineJoin::miter);
  const Mask bevel = square(LineJoin::bevel);
  const Mask round = square(LineJoin::round);
  // Covered part of the 4 x 4 square at a corner: all of it, half, and a quarter of a circle.
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
  // A side of 50 pixels holds five dashes of six pixels with gaps of four, starting at 20.
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(dashed.at(20 + 10 * i + 3, 20), 255) << i;
    EXPECT_EQ(dashed.at(20 + 10 * i + 8, 20), 0) << i;
    EXPECT_EQ(dashed.at(69, 20 + 10 * i + 3), 255) << i;
    EXPECT_EQ(dashed.at(69, 20 + 10 * i + 8), 0) << i;
  }
}

TEST(StrokeTest, DashesAreAsDenseAsLengthsAreAlongTheEdge) {
  const std::vector<PixelPoint> ends = {{10, 50}, {90, 50}};
  const auto dashed = [&](OutlineEdge edge, LineJoin join) {
    return draw_edges(ends, {edge}, {2, {6, 4}, join});
  };
  for (const LineJoin join : {LineJoin::bevel, LineJoin::round}) {
    const Mask twice = dashed({0, 1, 0, 2}, join);
    const Mask back = dashed({0, 1, 80 * kCells, -1}, join);
    const Mask forth = dashed({1, 0, 0, 1}, join);
    for (int i = 0; i < 8; ++i) {
      EXPECT_EQ(twice.at(10 + 5 * i + 1, 50), 255) << "a dash takes three pixels";
      EXPECT_EQ(twice.at(10 + 5 * i + 4, 50), 0);
      EXPECT_EQ(forth.at(89 - 10 * i - 3, 50), 255);
      EXPECT_EQ(forth.at(89 - 10 * i - 7, 50), 0);
    }
    EXPECT_EQ(back, forth);
  }
}

TEST(StrokeTest, DashesFarAlongTheOutlineAreAsNearItsBeginning) {
  const std::vector<PixelPoint> ends = {{10.2, 48.7}, {90.5, 53.1}};
  const Stroke stroke{2, {6, 4, 1, 3}, LineJoin::round};
  const Mask near = draw_edges(ends, {{0, 1, 0}}, stroke);
  EXPECT_EQ(near, draw_edges(ends, {{0, 1, 14.0 * 1024 * 1024 * kCells}}, stroke));
}

TEST(StrokeTest, ValuesAreMultipliedByTheInk) {
  for (const LineJoin join : {LineJoin::bevel, LineJoin::miter, LineJoin::round}) {
    const std::vector<OutlineEdge> corner = {{0, 1, 0, 1, 0.4}, {1, 2, 0, 1, 0.4}};
    const std::vector<PixelPoint> points = {{20, 20}, {70, 20}, {70, 70}};
    const Mask faded = draw_edges(points, corner, {3, {}, join});
    const Mask full = draw_edges(points, {{0, 1, 0}, {1, 2, 0}}, {3, {}, join});
    EXPECT_NEAR(area(faded) / area(full), 0.4, 0.005);
    EXPECT_EQ(std::ranges::max(testing::values_of(faded)), 102);
  }
  const Mask both = draw_edges({{20, 50}, {80, 50}, {50, 20}, {50, 80}},
                               {{0, 1, 0, 1, 0.2}, {2, 3, 0, 1, 0.6}}, {3, {}, LineJoin::round});
  EXPECT_EQ(both.at(50, 50), 153) << "the greatest value counts";
}

TEST(StrokeTest, InkOfARingGrowsWithItsExtent) {
  for (const double width : {0.5, 1.0, 3.0}) {
    const Stroke stroke{width, {}, LineJoin::round};
    EXPECT_EQ(stroke.ink_of_ring(0), 0);
    EXPECT_NEAR(stroke.ink_of_ring(width), 1 / Stroke::kFullExtent, 1e-12);
    EXPECT_EQ(stroke.ink_of_ring(Stroke::kFullExtent * width), 1);
    EXPECT_EQ(stroke.ink_of_ring(1e9), 1);
    for (double extent = 0; extent < 5 * width; extent += width / 64) {
      const double more = stroke.ink_of_ring(extent + width / 64) - stroke.ink_of_ring(extent);
      EXPECT_GE(more, 0);
      EXPECT_LT(more, 1.0 / 128) << "it does not jump";
    }
  }
}

TEST(StrokeTest, MasksNarrowerThanABlockAreDrawnToo) {
  const std::vector<Point> vertices = {{-100 * kCells, 2 * kCells}, {100 * kCells, 3 * kCells}};
  const auto drawn = [&](int width) {
    View view;
    view.cells_per_pixel = kCells;
    view.width = width;
    view.height = 5;
    const std::vector<OutlineEdge> edges = {{0, 1, 0}};
    Stroker stroker;
    stroker.begin(view, 1);
    stroker.add(vertices, edges);
    stroker.draw({2, {}, LineJoin::round});
    Mask mask;
    stroker.finish(mask);
    return mask;
  };
  const Mask wide = drawn(9);
  for (int width = 1; width < 9; ++width) {
    const Mask narrow = drawn(width);
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < width; ++column) {
        EXPECT_EQ(narrow.at(column, row), wide.at(column, row)) << width;
      }
    }
  }
}

TEST(StrokeTest, NothingIsLeftOpenBetweenManySmallEdges) {
  std::vector<PixelPoint> circle;
  for (int i = 0; i < 700; ++i) {  // edges a third of a pixel long
    const double angle = 2 * M_PI * i / 700;
    circle.push_back({50 + 40 * std::cos(angle), 50 + 40 * std::sin(angle)});
  }
  for (const LineJoin join : {LineJoin::bevel, LineJoin::miter, LineJoin::round}) {
    const Mask mask = draw_ring(circle, {3, {}, join});
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        const double off = std::abs(std::hypot(column + 0.5 - 50, row + 0.5 - 50) - 40);
        const double expected = std::clamp(2 - off, 0.0, 1.0) * 255;
        // The share of a pixel differs by a few percent from that of a segment across the line.
        ASSERT_NEAR(mask.at(column, row), expected, 8) << column << " " << row;
      }
    }
  }
}

/// The share of each pixel that is within half the width of any edge, by 16 x 16 points.
std::vector<double> covered_shares(const std::vector<PixelPoint>& points,
                                   const std::vector<OutlineEdge>& edges, double width) {
  constexpr int kPoints = 16;
  std::vector<double> shares;
  for (int place = 0; place < kSide * kSide; ++place) {
    const int column = place % kSide;
    const int row = place / kSide;
    std::vector<OutlineEdge> near;
    std::ranges::copy_if(edges, std::back_inserter(near), [&](const OutlineEdge& edge) {
      const auto [west, east] = std::minmax(points[edge.from].x, points[edge.to].x);
      const auto [north, south] = std::minmax(points[edge.from].y, points[edge.to].y);
      return column + 1 > west - width && column < east + width && row + 1 > north - width &&
             row < south + width;
    });
    int covered = 0;
    for (int point = 0; point < kPoints * kPoints; ++point) {
      const double x = column + (point % kPoints + 0.5) / kPoints;
      const double y = row + (point / kPoints + 0.5) / kPoints;
      covered += std::ranges::any_of(near, [&](const OutlineEdge& edge) {
        const PixelPoint a = points[edge.from];
        const PixelPoint b{points[edge.to].x - a.x, points[edge.to].y - a.y};
        const double part = ((x - a.x) * b.x + (y - a.y) * b.y) / (b.x * b.x + b.y * b.y);
        const double on_edge = std::clamp(part, 0.0, 1.0);
        return std::hypot(x - a.x - on_edge * b.x, y - a.y - on_edge * b.y) <= width / 2;
      });
    }
    shares.push_back(static_cast<double>(covered) / (kPoints * kPoints));
  }
  return shares;
}

TEST(StrokeTest, LinesCloserThanTheyAreWideCoverAPixelTogether) {
  for (const double angle : {0.0, 0.4, M_PI / 4, 1.2, M_PI / 2}) {
    for (const double apart : {0.2, 0.5, 0.9}) {
      std::vector<PixelPoint> points;
      std::vector<OutlineEdge> edges;
      for (std::uint32_t i = 0; i < 4; ++i) {
        const double along_x = 30 * std::cos(angle);
        const double along_y = 30 * std::sin(angle);
        const double x = 50.3 - i * apart * std::sin(angle);
        const double y = 50.4 + i * apart * std::cos(angle);
        points.push_back({x - along_x, y - along_y});
        points.push_back({x + along_x, y + along_y});
        edges.push_back({2 * i, 2 * i + 1, 0});
      }
      for (const LineJoin join : {LineJoin::round, LineJoin::bevel}) {
        const Mask mask = draw_edges(points, edges, {1, {}, join});
        const double expected = 60 * (1 + 3 * apart);
        EXPECT_NEAR(area(mask), expected, 0.07 * expected + 2) << angle << " " << apart;
      }
    }
  }
}

TEST(StrokeTest, CrowdsOfLinesCoverWhatTheirUnionDoes) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(5, 95);
  std::uniform_real_distribution<double> way(-6, 6);
  for (const double width : {0.5, 1.0, 1.5, 3.0}) {
    std::vector<PixelPoint> points;
    std::vector<OutlineEdge> edges;
    for (int line = 0; line < 60; ++line) {
      points.push_back({place(random), place(random)});
      for (int i = 0; i < 8; ++i) {
        const auto last = static_cast<std::uint32_t>(points.size() - 1);
        points.push_back({points[last].x + way(random), points[last].y + way(random)});
        edges.push_back({last, last + 1, 0});
      }
    }
    const Mask mask = draw_edges(points, edges, {width, {}, LineJoin::round});
    const std::vector<double> truth = covered_shares(points, edges, width);
    const std::vector<std::uint8_t> values = testing::values_of(mask);
    double sum = 0;
    int far = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double off = std::abs(values[i] - 255 * truth[i]);
      sum += off;
      far += off > 64;
    }
    EXPECT_LE(sum / kSide / kSide, 6) << width;
    EXPECT_LE(far, kSide * kSide / 500) << width;

    std::ranges::shuffle(edges, random);
    for (OutlineEdge& edge : edges) {
      if (random() % 2 == 0) std::swap(edge.from, edge.to);
    }
    EXPECT_EQ(draw_edges(points, edges, {width, {}, LineJoin::round}), mask) << "in any order";
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

TEST(StrokeTest, DashesTooFineToBeSeenAreATint) {
  const double solid = area(draw_ring(kSquare, {2, {}, LineJoin::bevel}));
  for (const double length : {0.4, 0.1, 0.01, 1e-300}) {
    const Mask half = draw_ring(kSquare, {2, {length, length}, LineJoin::bevel});
    EXPECT_NEAR(area(half) / solid, 0.5, 0.01) << length;
    const Mask quarter = draw_ring(kSquare, {2, {length, 3 * length}, LineJoin::bevel});
    EXPECT_NEAR(area(quarter) / solid, 0.25, 0.01) << length;
  }
}

// Outlines with so many edges that they are not drawn one by one.
class CrowdTest : public ::testing::Test {
 protected:
  /// A rough coast around the middle, within two pixels of a circle, with short edges.
  void add_coast(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> roughness(-2, 2);
    constexpr std::uint32_t kEdges = 2000;
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    for (std::uint32_t i = 0; i < kEdges; ++i) {
      const double angle = 2 * M_PI * i / kEdges;
      const double radius = 25 + roughness(random);
      vertices_.push_back({static_cast<std::int32_t>((50 + radius * std::cos(angle)) * kCells),
                           static_cast<std::int32_t>((50 + radius * std::sin(angle)) * kCells)});
      edges_.push_back({first + i, first + (i + 1) % kEdges, i * 0.2 * kCells});
    }
  }

  Mask draw(const Stroke& stroke, const Cancellation* cancellation = nullptr) {
    View view;
    view.cells_per_pixel = kCells;
    view.width = view.height = kSide;
    stroker_.begin(view, 1);
    stroker_.add(vertices_, edges_);
    stroker_.draw(stroke, cancellation);
    Mask mask;
    stroker_.finish(mask);
    return mask;
  }

  /// The distance from a place to the nearest edge, in pixels.
  double distance(double x, double y) const {
    double least = 1e9;
    for (const OutlineEdge& edge : edges_) {
      const double ax = 1.0 * vertices_[edge.from].x / kCells;
      const double ay = 1.0 * vertices_[edge.from].y / kCells;
      const double bx = 1.0 * vertices_[edge.to].x / kCells - ax;
      const double by = 1.0 * vertices_[edge.to].y / kCells - ay;
      const double part = ((x - ax) * bx + (y - ay) * by) / (bx * bx + by * by);
      const double on_edge = std::clamp(part, 0.0, 1.0);
      least = std::min(least, std::hypot(x - ax - on_edge * bx, y - ay - on_edge * by));
    }
    return least;
  }

  std::vector<Point> vertices_;
  std::vector<OutlineEdge> edges_;
  Stroker stroker_;
};

constexpr std::uint64_t kPixels = kSide * kSide;

TEST_F(CrowdTest, IsDrawnAsFarAsTheNearestEdge) {
  add_coast(1);
  for (const double width : {7.0, 16.0, 32.0}) {
    const Mask mask = draw({width, {}, LineJoin::round});
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        const double off = distance(column + 0.5, row + 0.5);
        const double expected = std::clamp(width / 2 + 0.5 - off, 0.0, 1.0) * 255;
        ASSERT_NEAR(mask.at(column, row), expected, 26) << column << " " << row << " " << width;
      }
    }
    EXPECT_LT(stroker_.values(), Stroker::kCrowd * kPixels) << width;
  }
}

TEST_F(CrowdTest, CostsNoMoreForWiderLines) {
  for (unsigned seed = 0; seed < 5; ++seed) add_coast(seed);
  draw({16, {}, LineJoin::miter});
  EXPECT_LT(stroker_.values(), Stroker::kCrowd * kPixels);
  draw({128, {6, 4}, LineJoin::bevel});
  EXPECT_LT(stroker_.values(), Stroker::kCrowd * kPixels);
}

TEST_F(CrowdTest, OfEqualOutlinesOneIsDrawn) {
  add_coast(1);
  draw({2, {6, 4}, LineJoin::round});
  const std::uint64_t once = stroker_.values();
  for (int i = 0; i < 50; ++i) add_coast(1);
  draw({2, {6, 4}, LineJoin::round});
  EXPECT_LT(stroker_.values(), 2 * once) << "and not 50 times as much";
}

TEST_F(CrowdTest, OfEqualOutlinesThatOfTheMostInkIsDrawn) {
  for (int i = 0; i < 50; ++i) add_coast(1);
  for (std::size_t i = 0; i < edges_.size(); ++i) edges_[i].ink = i / 2000 == 30 ? 1 : 0.25;
  const Mask mask = draw({2, {}, LineJoin::round});
  EXPECT_EQ(std::ranges::max(testing::values_of(mask)), 255);
}

TEST_F(CrowdTest, DashesAreThoseOfTheNearestEdge) {
  // A line across the picture in small steps, many times over.
  for (std::uint32_t i = 0; i <= 10'000; ++i) {
    const auto x = static_cast<std::int32_t>(i * 100 * kCells / 10'000);
    vertices_.push_back({x, 50 * kCells});
    if (i > 0) edges_.push_back({i - 1, i, 1.0 * vertices_[i - 1].x});
  }
  const Mask mask = draw({16, {20, 10}, LineJoin::bevel});
  EXPECT_LT(stroker_.values(), Stroker::kCrowd * kPixels);
  EXPECT_EQ(mask.at(40, 50), 255);
  EXPECT_EQ(mask.at(40, 43), 255);
  EXPECT_EQ(mask.at(25, 50), 0);
  EXPECT_EQ(mask.at(25, 43), 0);
  EXPECT_NEAR(area(mask) / kPixels, 0.16 * 2 / 3, 0.01);
}

// Small rings have less ink: near them, the line of a large ring further away is the darker one.
TEST_F(CrowdTest, OfAllLinesThatReachAPixelTheDarkestCounts) {
  add_coast(1);
  const std::size_t coast = edges_.size();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(5, 95);
  std::uniform_real_distribution<double> ink(0.05, 1);
  for (int ring = 0; ring < 600; ++ring) {
    const double x = place(random);
    const double y = place(random);
    const double share = ink(random);
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    for (std::uint32_t i = 0; i < 8; ++i) {
      vertices_.push_back({static_cast<std::int32_t>((x + std::cos(M_PI / 4 * i)) * kCells),
                           static_cast<std::int32_t>((y + std::sin(M_PI / 4 * i)) * kCells)});
      edges_.push_back({first + i, first + (i + 1) % 8, 0, 1, share});
    }
  }
  for (std::size_t i = 0; i < coast; ++i) edges_[i].ink = 0.5;
  for (const double width : {8.0, 20.0}) {
    const Mask crowded = draw({width, {}, LineJoin::round});
    ASSERT_LT(stroker_.values(), Stroker::kCrowd * kPixels) << width;
    // One by one, each ring for itself, so that none is a crowd.
    Mask alone = testing::mask_by(kSide, kSide, [](int, int) { return 0; });
    std::vector<std::uint8_t> darkest = testing::values_of(alone);
    for (std::size_t begin = 0; begin < edges_.size(); begin += 8) {
      View view;
      view.cells_per_pixel = kCells;
      view.width = view.height = kSide;
      stroker_.begin(view, 1);
      stroker_.add(vertices_, std::span(edges_).subspan(begin, 8));
      stroker_.draw({width, {}, LineJoin::round});
      Mask mask;
      stroker_.finish(mask);
      const auto values = testing::values_of(mask);
      for (std::size_t i = 0; i < values.size(); ++i) darkest[i] = std::max(darkest[i], values[i]);
    }
    int others = 0;
    int darker = 0;
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        const int expected = darkest[static_cast<std::size_t>(row * kSide + column)];
        const int off = crowded.at(column, row) - expected;
        ASSERT_GE(off, -26) << column << " " << row << " " << width;
        darker += off > 26;  // covered by several together
        others += std::abs(off) > 2;
      }
    }
    EXPECT_LT(others, static_cast<int>(kPixels) / 10) << width << ": along the rims of lines";
    EXPECT_LT(darker, static_cast<int>(kPixels) / 500) << width;
  }
}

TEST_F(CrowdTest, EndsWhenItIsNotWantedAnyLonger) {
  for (unsigned seed = 0; seed < 5; ++seed) add_coast(seed);
  Cancellation cancellation;
  cancellation.cancel();
  EXPECT_THROW(draw({1, {}, LineJoin::round}, &cancellation), Cancelled);
  EXPECT_THROW(draw({32, {}, LineJoin::round}, &cancellation), Cancelled);
  EXPECT_GT(area(draw({1, {}, LineJoin::round})), 0) << "and draws what is asked for next";
}

}  // namespace
}  // namespace trapeze
