#include "core/mesh/corner_rounding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/grid/box_margin.h"
#include "core/layer/layer_builder.h"
#include "tests/core/shapes/layers.h"
#include "tests/core/shapes/maps.h"
#include "tests/core/shapes/ring_text.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze {
namespace {

using PointOnWay = PlateCarreeMesh::PointOnWay;

constexpr std::int32_t kLarger = 1024;  // makes rounding to cells negligible

Rings larger(Rings rings) {
  for (Point& p : rings.points) p = {p.x * kLarger, p.y * kLarger};
  return rings;
}

std::unique_ptr<Layer> layer_of_text(const std::string& text) {
  return layer_of({larger(rings_from_text(text))});
}

/// Parcels that share borders, each with four bends, as one coverage.
std::unique_ptr<Layer> parcels(unsigned seed) {
  constexpr int kSide = 6;
  constexpr int kSize = 400;
  constexpr int kBends = 4;
  std::mt19937 random(seed);
  const auto off = [&random](int most) {
    return static_cast<int>(random() % (2 * most + 1)) - most;
  };
  std::map<std::pair<int, int>, Point> corner_at;
  const auto corner = [&](int x, int y) {
    const auto [found, is_new] = corner_at.try_emplace({x, y});
    if (is_new) found->second = {x * kSize + off(50), y * kSize + off(50)};
    return found->second;
  };
  // From west to east, or from north to south, without its ends.
  std::map<std::tuple<int, int, bool>, std::vector<Point>> border_at;
  const auto border = [&](int x, int y, bool is_level) {
    const auto [found, is_new] = border_at.try_emplace({x, y, is_level});
    const Point from = corner(x, y);
    const Point to = corner(x + (is_level ? 1 : 0), y + (is_level ? 0 : 1));
    for (int i = 1; is_new && i <= kBends; ++i) {
      found->second.push_back({from.x + (to.x - from.x) * i / (kBends + 1) + off(30),
                               from.y + (to.y - from.y) * i / (kBends + 1) + off(30)});
    }
    return found->second;
  };
  Map map;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      std::vector<Point> ring;
      const auto add = [&ring](Point begin, std::vector<Point> bends, bool is_forward) {
        if (!is_forward) std::ranges::reverse(bends);
        ring.push_back(begin);
        ring.insert(ring.end(), bends.begin(), bends.end());
      };
      add(corner(x, y), border(x, y, true), true);
      add(corner(x + 1, y), border(x + 1, y, false), true);
      add(corner(x + 1, y + 1), border(x, y + 1, true), false);
      add(corner(x, y + 1), border(x, y, false), false);
      Rings rings;
      rings.add(ring);
      map.push_back(larger(rings));
    }
  }
  LayerOptions options;
  options.coverage = CoverageMode::automatic;
  std::vector<LayerBuilder> builders;
  builders.emplace_back(options);
  FeatureTable table((std::vector<Field>()));
  std::vector<std::uint32_t> rows;
  std::vector<const Rings*> rings;
  for (const Rings& each : map) {
    rows.push_back(table.append(static_cast<std::int64_t>(rows.size()), {}));
    rings.push_back(&each);
  }
  EXPECT_TRUE(builders.front().add_coverage(rows, rings).apart.empty());
  return LayerBuilder::join(builders, std::move(table));
}

/// Every edge near the box, once.
std::set<std::uint32_t> add_all(const Layer& layer, const Box& box, CornerRounding& corners,
                                const std::set<std::uint32_t>& sharp = {}) {
  std::set<std::uint32_t> edges;
  std::vector<TrapezoidRange> ranges;
  corners.begin();
  corners.begin_piece(layer.mesh());
  layer.select({box, 0, 0, SmallPolygons::drop}, ranges);
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    const MeshTrapezoid& t = layer.mesh().trapezoids[i];
    corners.add(t, layer.feature_of(i), sharp.contains(layer.feature_of(i)));
    edges.insert({t.left, t.right});
  });
  layer.select_horizontal_edges(box, 0, ranges);
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    corners.add_edge(layer.mesh().trapezoids[i].left, false);
    edges.insert(layer.mesh().trapezoids[i].left);
  });
  return edges;
}

double doubled_area(std::span<const Point> ring) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    sum += static_cast<double>(orientation(ring[0], ring[i], ring[i + 1]));
  }
  return std::abs(sum);
}

/// Twice the area of the trapezoids, negative where their sides are swapped.
double doubled_area(const std::vector<Point>& vertices, const std::vector<MeshEdge>& edges,
                    const std::vector<MeshTrapezoid>& trapezoids) {
  double sum = 0;
  for (const MeshTrapezoid& t : trapezoids) {
    const EdgeLine left(vertices[edges[t.left].upper], vertices[edges[t.left].lower]);
    const EdgeLine right(vertices[edges[t.right].upper], vertices[edges[t.right].lower]);
    const double top = vertices[t.top].y;
    const double bottom = vertices[t.bottom].y;
    sum += (bottom - top) *
           (right.x_at(top) - left.x_at(top) + right.x_at(bottom) - left.x_at(bottom));
  }
  return sum;
}

bool cross(Point a, Point b, Point c, Point d) {
  const auto differ = [](std::int64_t one, std::int64_t other) {
    return (one > 0 && other < 0) || (one < 0 && other > 0);
  };
  return differ(orientation(a, b, c), orientation(a, b, d)) &&
         differ(orientation(c, d, a), orientation(c, d, b));
}

TEST(CornerRounding, ACornerIsAParabolaBetweenPointsOnItsEdges) {
  const auto square = layer_of_text("0 0, 100 0, 100 100, 0 100");
  CornerRounding corners;
  add_all(*square, kEverywhere, corners);
  corners.find({10, kLarger});
  ASSERT_EQ(corners.corners().size(), 4u);
  for (const CornerRounding::Corner& corner : corners.corners()) {
    const auto points = corners.points_of(corner);
    ASSERT_EQ(points.size() % 2, 1u);
    EXPECT_EQ(corner.inside, 0u);
    EXPECT_EQ(corner.outside, CornerRounding::kNoFace);
    for (const Point end : {points.front(), points.back()}) {
      EXPECT_EQ(std::abs(end.x - corner.tip.x) + std::abs(end.y - corner.tip.y), 10 * kLarger);
    }
    const Point middle = points[points.size() / 2];
    EXPECT_NEAR(std::abs(middle.x - corner.tip.x), 2.5 * kLarger, 1);
    EXPECT_NEAR(std::abs(middle.y - corner.tip.y), 2.5 * kLarger, 1);
  }
  add_all(*square, kEverywhere, corners);
  corners.find({80, kLarger});  // not beyond the midpoints
  for (const CornerRounding::Corner& corner : corners.corners()) {
    for (const double share : corner.shares) EXPECT_EQ(share, 0.5);
  }
}

TEST(CornerRounding, WhereAVertexLiesInTheTriangleTheCornerStays) {
  const auto holed = layer_of_text("0 0, 100 0, 100 100, 0 100; 8 8, 30 20, 20 30");
  CornerRounding corners;
  add_all(*holed, kEverywhere, corners);
  corners.find({20, kLarger});
  const auto is_rounded = [&](Point p) {
    return std::ranges::any_of(corners.corners(), [p](const auto& c) { return c.tip == p; });
  };
  EXPECT_FALSE(is_rounded({0, 0}));
  EXPECT_TRUE(is_rounded({100 * kLarger, 0}));
  EXPECT_TRUE(is_rounded({8 * kLarger, 8 * kLarger}));
}

TEST(CornerRounding, JunctionsAndSharpFacesStay) {
  const auto layer = parcels(3);
  CornerRounding corners;
  const std::set<std::uint32_t> edges = add_all(*layer, kEverywhere, corners);
  corners.find({20, kLarger});
  std::map<std::uint32_t, int> edges_at;
  for (const std::uint32_t edge : edges) {
    ++edges_at[layer->mesh().edges[edge].upper];
    ++edges_at[layer->mesh().edges[edge].lower];
  }
  EXPECT_FALSE(corners.corners().empty());
  for (const auto& corner : corners.corners()) EXPECT_EQ(edges_at[corner.vertex], 2);
  const std::uint32_t face = corners.corners().front().inside;
  ASSERT_NE(face, CornerRounding::kNoFace);
  add_all(*layer, kEverywhere, corners, {face});
  corners.find({20, kLarger});
  for (const auto& corner : corners.corners()) {
    EXPECT_NE(corner.inside, face);
    EXPECT_NE(corner.outside, face);
  }
}

TEST(CornerRounding, ACornerThatIsLeftSharpChangesNoOther) {
  const auto square = layer_of_text("0 0, 100 0, 100 100, 0 100");
  CornerRounding corners;
  const std::set<std::uint32_t> edges = add_all(*square, kEverywhere, corners);
  corners.find({20, kLarger});
  ASSERT_EQ(corners.corners().size(), 4u);
  const std::uint32_t left = corners.corners()[1].vertex;
  const std::uint32_t other = corners.corners()[2].vertex;
  const std::span<const Point> points = corners.points_of(corners.corners()[2]);
  const std::vector<Point> before(points.begin(), points.end());
  corners.leave_sharp(0, std::vector{left});
  EXPECT_EQ(corners.corners().size(), 3u);
  EXPECT_EQ(corners.corner_at(0, left), nullptr);
  ASSERT_NE(corners.corner_at(0, other), nullptr);
  EXPECT_TRUE(std::ranges::equal(corners.points_of(*corners.corner_at(0, other)), before));
  std::vector<PointOnWay> way;
  int ends = 0;
  for (const std::uint32_t edge : edges) {
    corners.trace(0, square->mesh(), edge, way);
    for (const PointOnWay& end : {way.front(), way.back()}) {
      ends += end.place == square->mesh().vertices[left] ? 1 : 0;
    }
  }
  EXPECT_EQ(ends, 2);
}

TEST(CornerRounding, PlacesHaveTheAreaBetweenTheCornerAndTheCurve) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const auto layer = layer_of({larger(random_shape(seed))});
    CornerRounding corners;
    add_all(*layer, kEverywhere, corners);
    corners.find({30, kLarger});
    for (const CornerRounding::Corner& corner : corners.corners()) {
      std::vector<Point> ring{corner.tip};
      const auto points = corners.points_of(corner);
      ring.insert(ring.end(), points.begin(), points.end());
      for (const bool is_hole : {false, true}) {
        std::vector<Point> vertices;
        std::vector<MeshEdge> edges;
        std::vector<MeshTrapezoid> trapezoids;
        corners.append_place(corner, is_hole, vertices, edges, trapezoids);
        const double area = doubled_area(vertices, edges, trapezoids);
        const double wanted = doubled_area(ring);
        ASSERT_NEAR(is_hole ? -area : area, wanted, 1e-6 * wanted + 1) << seed;
        // A third of the triangle, apart from the effect of the chords.
        const double triangle = doubled_area(std::vector<Point>{ring[0], ring[1], ring.back()});
        ASSERT_GT(wanted, 0.3 * triangle) << seed;
        ASSERT_LT(wanted, 0.51 * triangle) << seed;
      }
    }
  }
}

TEST(CornerRounding, NothingComesToCross) {
  std::size_t rounded = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const auto layer = seed % 3 == 0 ? parcels(seed) : layer_of({larger(random_shape(seed))});
    CornerRounding corners;
    const std::set<std::uint32_t> edges = add_all(*layer, kEverywhere, corners);
    if (edges.size() > 400) continue;
    corners.find({seed % 2 == 0 ? 1000.0 : 15.0, kLarger});
    rounded += corners.corners().size();
    std::vector<std::pair<Point, Point>> lines;
    std::map<std::pair<std::int32_t, std::int32_t>, int> lines_at;
    std::vector<PointOnWay> way;
    for (const std::uint32_t edge : edges) {
      corners.trace(0, layer->mesh(), edge, way);
      ASSERT_GE(way.size(), 2u);
      ASSERT_GE(way.front().share, 0);
      ASSERT_LE(way.back().share, 1);
      for (std::size_t i = 1; i < way.size(); ++i) {
        ASSERT_LT(way[i - 1].share, way[i].share);
        lines.emplace_back(way[i - 1].place, way[i].place);
      }
      for (const Point end : {way.front().place, way.back().place}) ++lines_at[{end.x, end.y}];
    }
    for (const auto& [place, count] : lines_at) ASSERT_GE(count, 2) << "an open end, " << seed;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      for (std::size_t k = i + 1; k < lines.size(); ++k) {
        ASSERT_FALSE(cross(lines[i].first, lines[i].second, lines[k].first, lines[k].second))
            << seed;
      }
    }
  }
  EXPECT_GT(rounded, 500u);
}

TEST(CornerRounding, DoesNotDependOnWhatLiesBeyondTwiceTheRadius) {
  constexpr double kRadius = 40;
  constexpr auto kRadiusInCells = static_cast<std::int32_t>(kRadius * kLarger) + 1;
  std::size_t compared = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    const auto layer = seed % 2 == 0 ? parcels(seed) : layer_of({larger(random_shape(seed))});
    const Box bounds = layer->bounds();
    const Box view{bounds.min_x, bounds.min_y, (bounds.min_x + bounds.max_x) / 2,
                   (bounds.min_y + bounds.max_y) / 2};
    const CornerRounding::Size size{kRadius, kLarger, with_margin(view, kRadiusInCells)};
    CornerRounding all;
    add_all(*layer, kEverywhere, all);
    all.find(size);
    CornerRounding some;
    const auto edges = add_all(*layer, with_margin(view, 2 * kRadiusInCells), some);
    some.find(size);
    const auto shapes_of = [](const CornerRounding& corners) {
      std::vector<std::vector<std::pair<std::int32_t, std::int32_t>>> shapes;
      for (const CornerRounding::Corner& corner : corners.corners()) {
        auto& shape = shapes.emplace_back();
        for (const Point p : corners.points_of(corner)) shape.emplace_back(p.x, p.y);
        shape.emplace_back(static_cast<std::int32_t>(corner.inside),
                           static_cast<std::int32_t>(corner.outside));
      }
      return shapes;
    };
    EXPECT_EQ(shapes_of(some), shapes_of(all)) << seed;
    compared += shapes_of(all).size();
    // Includes edges with one end in view and the other far away.
    std::vector<PointOnWay> way;
    std::vector<PointOnWay> same;
    for (const std::uint32_t edge : edges) {
      some.trace(0, layer->mesh(), edge, way);
      all.trace(0, layer->mesh(), edge, same);
      EXPECT_TRUE(std::ranges::equal(way, same, {}, &PointOnWay::place, &PointOnWay::place));
    }
  }
  EXPECT_GT(compared, 100u);
}

}  // namespace
}  // namespace trapeze
