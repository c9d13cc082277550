#include "core/mesh/exaggeration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/layer/layer_builder.h"
#include "tests/core/shapes/layers.h"
#include "tests/core/shapes/ring_text.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze {
namespace {

constexpr double kPixel = 4096;  // cells; makes rounding to cells negligible

using Ring = std::vector<Vector>;  // in pixels

Ring rectangle(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

Ring rotated(Ring ring, double angle) {
  for (Vector& p : ring) {
    p = {p.x * std::cos(angle) - p.y * std::sin(angle),
         p.x * std::sin(angle) + p.y * std::cos(angle)};
  }
  return ring;
}

Rings rings_of(const Ring& ring) {
  std::vector<Point> points;
  for (const Vector p : ring) {
    points.push_back({static_cast<std::int32_t>(std::lround(p.x * kPixel)),
                      static_cast<std::int32_t>(std::lround(p.y * kPixel))});
  }
  Rings rings;
  rings.add(points);
  return rings;
}

std::unique_ptr<Layer> layer_with(const std::vector<Ring>& polygons, bool is_coverage = false) {
  std::vector<Rings> rings;
  for (const Ring& ring : polygons) rings.push_back(rings_of(ring));
  if (!is_coverage) return layer_of(std::move(rings));
  LayerOptions options;
  options.coverage = CoverageMode::automatic;
  std::vector<LayerBuilder> builders;
  builders.emplace_back(options);
  FeatureTable table((std::vector<Field>()));
  std::vector<std::uint32_t> rows;
  std::vector<const Rings*> all;
  for (const Rings& each : rings) {
    rows.push_back(table.append(static_cast<std::int64_t>(rows.size()), {}));
    all.push_back(&each);
  }
  EXPECT_TRUE(builders.front().add_coverage(rows, all).apart.empty());
  return LayerBuilder::join(builders, std::move(table));
}

/// The parts of a layer that grow to that width, in pixels.
class Grown {
 public:
  Grown(const Layer& layer, double width, const Box& box = kEverywhere) : layer_(layer) {
    Box around = box;
    if (box != kEverywhere) {
      const auto reach = static_cast<std::int32_t>(Exaggeration::reach_of(width) * kPixel) + 2;
      around = {box.min_x - reach, box.min_y - reach, box.max_x + reach, box.max_y + reach};
    }
    BoundaryMap& boundary = all_.boundary();
    boundary.begin();
    boundary.begin_piece(layer.mesh());
    std::vector<TrapezoidRange> ranges;
    layer.select({around, 0, 0, SmallPolygons::drop}, ranges);
    for_each_trapezoid(ranges, [&](std::uint32_t i) {
      if (!layer.overlaps().of(layer.feature_of(i)).empty()) return;
      boundary.add(layer.mesh().trapezoids[i], layer.feature_of(i));
      trapezoids_.push_back(i);
    });
    layer.select_horizontal_edges(around, 0, ranges);
    for_each_trapezoid(ranges, [&](std::uint32_t i) {
      if (!layer.overlaps().of(layer.feature_of(i)).empty()) return;
      boundary.add_edge(layer.mesh().trapezoids[i].left);
    });
    all_.find({width, kPixel}, box == kEverywhere ? layer.bounds() : box, nullptr);
  }

  const Exaggeration& all() const { return all_; }

  /// The area that a face has grown by, in pixels.
  double area(std::uint32_t face) const {
    double sum = 0;
    for (const auto& t : all_.triangles()) {
      if (BoundaryMap::number_of(t.face) == face) sum += area_of(t);
    }
    return sum;
  }
  double area() const {
    double sum = 0;
    for (const auto& t : all_.triangles()) sum += area_of(t);
    return sum;
  }

  /// The number of triangles that contain a position, which must not lie on a side of one.
  int triangles_at(Vector place) const {
    return static_cast<int>(
        std::ranges::count_if(all_.triangles(), [&](const auto& t) { return holds(t, place); }));
  }
  /// The face that has grown over a position, or -1.
  int face_grown_over(Vector place) const {
    for (const auto& t : all_.triangles()) {
      if (holds(t, place)) return static_cast<int>(BoundaryMap::number_of(t.face));
    }
    return -1;
  }
  /// The face that contains a position without growing, or -1.
  int face_at(Vector place) const {
    const MeshView& mesh = layer_.mesh();
    const double x = place.x * kPixel;
    const double y = place.y * kPixel;
    for (const std::uint32_t i : trapezoids_) {
      const MeshTrapezoid& t = mesh.trapezoids[i];
      if (y < mesh.vertices[t.top].y || y >= mesh.vertices[t.bottom].y) continue;
      if (x < EdgeLine(mesh, t.left).x_at(y) || x >= EdgeLine(mesh, t.right).x_at(y)) continue;
      return static_cast<int>(layer_.feature_of(i));
    }
    return -1;
  }
  /// The area that faces lose to growing ones, in pixels.
  double area_in_common() const {
    std::vector<Point> vertices;
    std::vector<MeshEdge> edges;
    std::vector<MeshTrapezoid> cut;
    for (const std::uint32_t i : trapezoids_) {
      all_.append_common(layer_.mesh(), layer_.mesh().trapezoids[i], vertices, edges, cut);
    }
    double sum = 0;
    for (const MeshTrapezoid& t : cut) {
      const EdgeLine left(vertices[edges[t.right].upper], vertices[edges[t.right].lower]);
      const EdgeLine right(vertices[edges[t.left].upper], vertices[edges[t.left].lower]);
      const double top = vertices[t.top].y;
      const double bottom = vertices[t.bottom].y;
      sum += (bottom - top) / 2 *
             (right.x_at(top) - left.x_at(top) + right.x_at(bottom) - left.x_at(bottom));
    }
    return sum / kPixel / kPixel;
  }

 private:
  static double area_of(const Exaggeration::Triangle& t) {
    return std::abs(static_cast<double>(orientation(t.corners[0], t.corners[1], t.corners[2]))) /
           2 / kPixel / kPixel;
  }
  static bool holds(const Exaggeration::Triangle& t, Vector place) {
    const Vector p = place * kPixel;
    int sides = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector a = to_vector(t.corners[i]);
      const Vector b = to_vector(t.corners[(i + 1) % 3]);
      sides += cross(b - a, p - a) > 0 ? 1 : -1;
    }
    return std::abs(sides) == 3;
  }

  const Layer& layer_;
  Exaggeration all_;
  std::vector<std::uint32_t> trapezoids_;
};

/// Buildings of all sizes in all directions, and narrow strips between them, without overlaps.
std::vector<Ring> town(unsigned seed) {
  std::mt19937 random(seed);
  const auto between = [&random](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  std::vector<Ring> polygons;
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 6; ++x) {
      Ring ring = rectangle(0, 0, between(0.4, 5), between(0.4, 5));
      if (seed % 3 == 1) ring = {{0, 0}, {between(1, 6), between(0, 2)}, {between(0, 2), 4}};
      if (seed % 3 == 2) {
        const double w = between(0.3, 1);
        ring = {{0, 0}, {5, 0}, {5, w}, {w, w}, {w, 5}, {0, 5}};
      }
      ring = rotated(ring, between(0, 6.28));
      Vector least{100, 100};
      for (const Vector p : ring) least = {std::min(least.x, p.x), std::min(least.y, p.y)};
      // Each of them fits into a square of 8 pixels.
      for (Vector& p : ring) p = p - least + Vector{x * 8.1 + 0.05, y * 8.1 + 0.05};
      polygons.push_back(ring);
    }
  }
  return polygons;
}

TEST(Exaggeration, AStripBecomesAsWideAsAskedAtAnyAngle) {
  for (int degrees = 0; degrees < 360; degrees += 17) {
    const double angle = degrees * std::numbers::pi / 180;
    for (const double width : {1.5, 3.0, 8.0}) {
      const Ring strip = rotated(rectangle(-10, -0.5, 20, 1), angle);
      const auto layer = layer_with({strip});
      const Grown grown(*layer, width);
      EXPECT_NEAR(grown.area(), 20 * (width - 1), 0.02 * width) << degrees << ' ' << width;
      for (double along = -9.7; along < 9.8; along += 0.61) {
        for (const double across : {0.51, width / 2 - 0.02, -0.51, -width / 2 + 0.02}) {
          const Vector place = rotated({{along, across}}, angle).front();
          EXPECT_EQ(grown.triangles_at(place), 1) << degrees << ' ' << along << ' ' << across;
        }
        for (const double across : {0.49, width / 2 + 0.02, -width / 2 - 0.02}) {
          const Vector place = rotated({{along, across}}, angle).front();
          EXPECT_EQ(grown.triangles_at(place), 0) << degrees << ' ' << along << ' ' << across;
        }
      }
    }
  }
}

TEST(Exaggeration, ASmallHouseBecomesASquare) {
  for (int degrees = 0; degrees < 90; degrees += 13) {
    const Ring house = rotated(rectangle(0, 0, 1, 0.5), degrees * std::numbers::pi / 180);
    const auto layer = layer_with({house});
    EXPECT_NEAR(Grown(*layer, 2).area(), 4 - 0.5, 0.02) << degrees;
    EXPECT_NEAR(Grown(*layer, 6).area(), 36 - 0.5, 0.1) << degrees;
    EXPECT_NEAR(Grown(*layer, 0.8).area(), 0.8 - 0.5, 0.01) << degrees;
    EXPECT_EQ(Grown(*layer, 0.4).area(), 0) << degrees;
  }
}

TEST(Exaggeration, EndsThatAreNotQuiteSquareAreNoNarrowPlaces) {
  for (const double slant : {-0.3, -0.05, 0.05, 0.3}) {
    const auto layer = layer_with({{{0, 0}, {20, 0}, {20 + slant, 1}, {slant, 1}}});
    EXPECT_NEAR(Grown(*layer, 4).area(), 3 * 20, 1.2) << slant;
  }
}

TEST(Exaggeration, WhatIsWideStaysAsItIs) {
  const std::vector<Ring> wide = {
      rectangle(0, 0, 9, 9),
      {{20, 0}, {38, 0}, {29, 15.588}},                                    // 60 degrees at each
      {{40, 0}, {60, 0}, {60, 9}, {49, 9}, {49, 20}, {40, 20}},            // an L
      {{70, 0}, {90, 0}, {95, 10}, {90, 20}, {80, 12}, {70, 20}, {62, 9}}  // a bay
  };
  for (int degrees = 0; degrees < 180; degrees += 19) {
    for (const Ring& ring : wide) {
      const auto layer = layer_with({rotated(ring, degrees * std::numbers::pi / 180)});
      EXPECT_LT(Grown(*layer, 6).area(), 0.002) << degrees << ' ' << ring.size();
    }
  }
}

TEST(Exaggeration, OnlyTheNarrowPartOfAPolygonGrows) {
  // A square with an arm.
  const Ring square{{0, 0}, {12, 0}, {12, 5}, {30, 5}, {30, 6}, {12, 6}, {12, 12}, {0, 12}};
  const auto layer = layer_with({square});
  const Grown grown(*layer, 3);
  EXPECT_EQ(grown.triangles_at({25, 4.1}), 1);
  EXPECT_EQ(grown.triangles_at({25, 6.9}), 1);
  EXPECT_EQ(grown.triangles_at({-0.1, 6}), 0);
  EXPECT_EQ(grown.triangles_at({6, -0.1}), 0);
  EXPECT_EQ(grown.triangles_at({30.1, 5.5}), 0) << "an end is not narrow";
  EXPECT_GT(grown.area(), 2 * 13);
  EXPECT_LT(grown.area(), 2 * 18);
}

TEST(Exaggeration, TwoThatGrowTowardsEachOtherShareTheVoid) {
  for (int degrees = 0; degrees < 180; degrees += 23) {
    const double angle = degrees * std::numbers::pi / 180;
    const auto layer = layer_with(
        {rotated(rectangle(0, 0, 20, 1), angle), rotated(rectangle(0, 1.6, 20, 0.4), angle)});
    const Grown grown(*layer, 5);
    for (double x = 1; x < 19; x += 0.7) {
      EXPECT_EQ(grown.face_grown_over(rotated({{x, 1.28}}, angle).front()), 0);
      EXPECT_EQ(grown.face_grown_over(rotated({{x, 1.32}}, angle).front()), 1);
      EXPECT_EQ(grown.face_grown_over(rotated({{x, -1.95}}, angle).front()), 0);
      EXPECT_EQ(grown.face_grown_over(rotated({{x, 2 + 2.25}}, angle).front()), 1);
    }
  }
}

TEST(Exaggeration, OneThatNeedsLessLeavesTheRestToTheOther) {
  const auto layer = layer_with({rectangle(0, 0, 20, 1), rectangle(0, 3, 20, 4.8)});
  const Grown grown(*layer, 5);  // by 2, and by 0.1, into a gap of 2
  EXPECT_EQ(grown.face_grown_over({10, 2.85}), 0);
  EXPECT_EQ(grown.face_grown_over({10, 2.95}), 1);
}

TEST(Exaggeration, HousesOfARowGrowToTheFrontAndNotIntoEachOther) {
  for (const bool is_coverage : {false, true}) {
    std::vector<Ring> row;
    for (int i = 0; i < 6; ++i) row.push_back(rectangle(i, 0, 1, 1));
    const auto layer = layer_with(row, is_coverage);
    const Grown grown(*layer, 2);
    for (int i = 1; i < 5; ++i) {
      for (const double x : {0.05, 0.3, 0.5, 0.95}) {
        EXPECT_EQ(grown.face_grown_over({i + x, -0.45}), i) << x << is_coverage;
        EXPECT_EQ(grown.face_grown_over({i + x, 1.45}), i) << x << is_coverage;
      }
      EXPECT_NEAR(grown.area(static_cast<std::uint32_t>(i)), 1, 0.02) << is_coverage;
    }
    EXPECT_NEAR(grown.area_in_common(), 0, 1e-3);
  }
}

TEST(Exaggeration, ARiverGrowsOverFieldsAndNotOverANarrowStrip) {
  const std::vector<Ring> land = {rectangle(0, 0, 40, 20), rectangle(0, 20, 40, 1),
                                  rectangle(0, 21, 40, 20)};
  const auto layer = layer_with(land, true);
  const Grown river(*layer, 4);
  for (double x = 3; x < 37; x += 0.9) {
    EXPECT_EQ(river.face_grown_over({x, 18.55}), 1) << x;
    EXPECT_EQ(river.face_grown_over({x, 22.45}), 1) << x;
    EXPECT_EQ(river.face_grown_over({x, 18.45}), -1) << x;
  }
  EXPECT_NEAR(river.area_in_common(), river.area(), 0.01 * river.area());

  const auto narrow = layer_with(
      {rectangle(0, 0, 40, 20), rectangle(0, 20, 40, 1), rectangle(0, 21, 40, 1.5)}, true);
  const Grown both(*narrow, 4);
  for (double x = 3; x < 37; x += 0.9) {
    EXPECT_EQ(both.face_grown_over({x, 21.1}), -1) << x;
    EXPECT_EQ(both.face_grown_over({x, 20.9}), -1) << x;
    EXPECT_EQ(both.face_grown_over({x, 18.6}), 1) << x;
  }
}

TEST(Exaggeration, AFieldKeepsTheWidthItself) {
  // Rivers on both sides of a field of 5 pixels, which may lose one pixel in all.
  const auto layer =
      layer_with({rectangle(0, 0, 40, 1), rectangle(0, 1, 40, 5), rectangle(0, 6, 40, 1)}, true);
  const Grown grown(*layer, 4);
  for (double x = 8; x < 32; x += 0.9) {
    EXPECT_EQ(grown.face_grown_over({x, 1.45}), 0) << x;
    EXPECT_EQ(grown.face_grown_over({x, 1.6}), -1) << x;
    EXPECT_EQ(grown.face_grown_over({x, 5.4}), -1) << x;
    EXPECT_EQ(grown.face_grown_over({x, 5.55}), 2) << x;
  }
}

TEST(Exaggeration, InTownsNothingIsCoveredTwice) {
  std::size_t covered = 0;
  std::size_t twice = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    const auto layer = layer_with(town(seed));
    const Grown grown(*layer, 4);
    EXPECT_LT(grown.area_in_common(), 0.001 * grown.area()) << seed;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> anywhere(-3, 52);
    for (int i = 0; i < 3000; ++i) {
      const Vector place{anywhere(random), anywhere(random)};
      const int times = grown.triangles_at(place);
      covered += times > 0 ? 1 : 0;
      twice += times > 1 ? 1 : 0;
    }
  }
  EXPECT_GT(covered, 3000u);
  EXPECT_LT(twice, covered / 1000) << "between places that are looked at, strips are straight";
}

TEST(Exaggeration, GrowsWithTheWidthAndWithoutJumps) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const auto polygons = town(seed);
    const auto layer = layer_with(polygons);
    double last = 0;
    for (double width = 0.5; width <= 6; width += 0.5) {
      const double area = Grown(*layer, width).area();
      EXPECT_GE(area, last * 0.995) << seed << ' ' << width;
      const double more = Grown(*layer, width * 1.001).area();
      EXPECT_NEAR(more, area, 0.02 * area + 0.5) << seed << ' ' << width;
      last = area;
    }
    EXPECT_GT(last, 100);
  }
}

TEST(Exaggeration, DoesNotDependOnTheOrderOfFeatures) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    std::vector<Ring> polygons = town(seed);
    const double area = Grown(*layer_with(polygons), 4).area();
    std::ranges::reverse(polygons);
    EXPECT_DOUBLE_EQ(Grown(*layer_with(polygons), 4).area(), area) << seed;
  }
}

TEST(Exaggeration, DoesNotDependOnWhatIsFarAway) {
  std::size_t compared = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    const auto layer = layer_with(town(seed));
    const double width = 1.5;
    const Grown all(*layer, width);
    const auto cells = [](double x) { return static_cast<std::int32_t>(x * kPixel); };
    const Box view{cells(18), cells(18), cells(31), cells(31)};
    const Grown some(*layer, width, view);
    const auto shapes = [&view](const Grown& grown) {
      std::vector<std::array<std::int32_t, 6>> all_corners;
      for (const auto& t : grown.all().triangles()) {
        Box around;
        for (const Point p : t.corners) around.include(p);
        if (!around.intersects(view)) continue;
        const auto& [a, b, c] = t.corners;
        all_corners.push_back({a.x, a.y, b.x, b.y, c.x, c.y});
      }
      std::ranges::sort(all_corners);
      return all_corners;
    };
    EXPECT_EQ(shapes(some), shapes(all)) << seed;
    compared += shapes(all).size();
  }
  EXPECT_GT(compared, 100u);
}

TEST(Exaggeration, TheWayOfAnEdgeIsThatOfTheMovedBoundary) {
  const Ring strip = rotated(rectangle(0, 0, 12, 1), 0.3);
  const auto layer = layer_with({strip});
  const Grown grown(*layer, 3);
  std::vector<PlateCarreeMesh::PointOnWay> way;
  std::vector<Vector> ends;
  double around = 0;
  for (std::uint32_t edge = 0; edge < layer->mesh().edges.size(); ++edge) {
    if (grown.all().boundary().edge_number(0, edge) == BoundaryMap::kNone) continue;
    grown.all().trace(0, layer->mesh(), edge, way);
    ASSERT_GE(way.size(), 2u);
    for (std::size_t i = 1; i < way.size(); ++i) {
      around += length(to_vector(way[i].place) - to_vector(way[i - 1].place)) / kPixel;
    }
    for (const Point end : {way.front().place, way.back().place}) ends.push_back(to_vector(end));
  }
  EXPECT_NEAR(around, 2 * (12 + 3), 0.1);
  EXPECT_EQ(ends.size(), 8u);
  for (const Vector end : ends) {
    EXPECT_EQ(std::ranges::count_if(ends, [end](Vector v) { return length(v - end) < 2; }), 2);
  }
}

TEST(Exaggeration, RandomShapesOfAllKindsStayWithoutOverlaps) {
  for (unsigned seed = 0; seed < 42; ++seed) {
    Rings rings = random_shape(seed);
    Box bounds;
    for (const Point p : rings.points) bounds.include(p);
    const double side = std::max(bounds.max_x - bounds.min_x, bounds.max_y - bounds.min_y);
    for (Point& p : rings.points) {
      p = {static_cast<std::int32_t>(p.x * 100 * kPixel / side),
           static_cast<std::int32_t>(p.y * 100 * kPixel / side)};
    }
    const auto layer = layer_of({rings});
    const Grown grown(*layer, 3);
    EXPECT_LT(grown.area_in_common(), 0.005 * grown.area() + 0.02) << seed;
  }
}

}  // namespace
}  // namespace trapeze
