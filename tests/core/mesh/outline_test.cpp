#include "core/mesh/outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "core/layer/layer_builder.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze {
namespace {

constexpr Box kWorld{kGridMin, kGridMin, kGridMax, kGridMax};

std::unique_ptr<Layer> layer_of_polygon(Rings rings) {
  std::vector<LayerBuilder> builders(1);
  FeatureTable table(std::vector<Field>{});
  builders.front().add(table.append(0, {}), rings);
  return LayerBuilder::join(builders, std::move(table));
}

std::unique_ptr<Layer> coverage_of(const std::vector<Rings>& features) {
  LayerOptions options;
  options.coverage = CoverageMode::on;
  std::vector<LayerBuilder> builders;
  builders.emplace_back(options);
  FeatureTable table(std::vector<Field>{});
  std::vector<std::uint32_t> rows;
  std::vector<const Rings*> rings;
  for (const Rings& feature : features) {
    rows.push_back(table.append(static_cast<std::int64_t>(rows.size()), {}));
    rings.push_back(&feature);
  }
  EXPECT_EQ(builders.front().add_coverage(rows, rings).together.size(), features.size());
  return LayerBuilder::join(builders, std::move(table));
}

/// The edges of the boundary at a level.
std::set<std::uint32_t> edges_at(const Layer& layer, Level level) {
  std::set<std::uint32_t> edges;
  std::vector<TrapezoidRange> ranges;
  const auto add = [&](std::uint32_t i) {
    edges.insert(layer.mesh().trapezoids[i].left);
    edges.insert(layer.mesh().trapezoids[i].right);
  };
  layer.select({kWorld, level, kLastLevel, SmallPolygons::drop}, ranges);
  for_each_trapezoid(ranges, add);
  layer.select_horizontal_edges(kWorld, level, ranges);
  for_each_trapezoid(ranges, add);
  return edges;
}

double length_of(const Layer& layer, std::uint32_t edge) {
  const MeshEdge& ends = layer.mesh().edges[edge];
  const Point a = layer.mesh().vertices[ends.upper];
  const Point b = layer.mesh().vertices[ends.lower];
  return std::hypot(static_cast<double>(b.x) - a.x, static_cast<double>(b.y) - a.y);
}

Rings square(std::int32_t x, std::int32_t y, std::int32_t side) {
  Rings rings;
  rings.points = {{x, y}, {x, y + side}, {x + side, y + side}, {x + side, y}};
  rings.close_ring();
  return rings;
}

/// A circle with roughness at all scales, made by moving the midpoint of every edge sideways.
Rings rough_coast(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> beside(0, 0.22);
  std::vector<std::pair<double, double>> points = {
      {-1e8, -1e8}, {-1e8, 1e8}, {1e8, 1e8}, {1e8, -1e8}};
  for (int step = 0; step < 11; ++step) {
    std::vector<std::pair<double, double>> finer;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto [ax, ay] = points[i];
      const auto [bx, by] = points[(i + 1) % points.size()];
      const double off = beside(random);
      finer.emplace_back(ax, ay);
      finer.emplace_back((ax + bx) / 2 + off * (by - ay), (ay + by) / 2 - off * (bx - ax));
    }
    points.swap(finer);
  }
  Rings rings;
  for (const auto& [x, y] : points) {
    rings.points.push_back(
        {static_cast<std::int32_t>(std::lround(x)), static_cast<std::int32_t>(std::lround(y))});
  }
  rings.close_ring();
  return rings;
}

TEST(OutlineTest, SizesTellTheExtentOfACircleOfTheArea) {
  for (double extent = 1; extent < 3e9; extent *= 1.37) {
    const double area = std::numbers::pi * extent * extent / 4;
    EXPECT_NEAR(extent_of(loop_size_of(area)) / extent, 1, 0.045) << extent;
  }
  EXPECT_EQ(loop_size_of(0), 0);
  EXPECT_EQ(loop_size_of(0.3), 0);
  EXPECT_EQ(loop_size_of(1e300), kLoopSizes - 1);
}

TEST(OutlineTest, EdgesHaveTheSizeOfTheirLoop) {
  Rings rings = square(0, 0, 1000);
  const Rings hole = square(400, 400, 30);
  rings.add(hole[0]);
  const auto layer = layer_of_polygon(rings);
  const std::set<std::uint32_t> edges = edges_at(*layer, 0);
  ASSERT_EQ(edges.size(), 8u);
  for (const std::uint32_t edge : edges) {
    const double side = length_of(*layer, edge);
    EXPECT_EQ(layer->outline().loop_size(edge), loop_size_of(side * side)) << side;
  }
}

TEST(OutlineTest, EdgesBetweenFeaturesHaveTheSizeOfTheLargerLoop) {
  // A small square at the side of a large one, and one that lies inside it.
  Rings large = square(0, 0, 1000);
  large.add(square(300, 300, 100)[0]);
  const auto layer = coverage_of({large, square(1000, 200, 50), square(300, 300, 100)});
  std::map<std::int32_t, LoopSize> by_x;  // edges that lead down
  for (const std::uint32_t edge : edges_at(*layer, 0)) {
    const MeshEdge& ends = layer->mesh().edges[edge];
    const Point upper = layer->mesh().vertices[ends.upper];
    if (upper.x == layer->mesh().vertices[ends.lower].x && upper.y >= 200) {
      by_x[upper.x] = layer->outline().loop_size(edge);
    }
  }
  EXPECT_EQ(by_x.at(1000), loop_size_of(1e6)) << "between the large one and the small one";
  EXPECT_EQ(by_x.at(1050), loop_size_of(2500)) << "the small one, as if it were alone";
  EXPECT_EQ(by_x.at(300), loop_size_of(1e4)) << "of the one within";
}

struct Joints {
  std::size_t count = 0;   // vertices between two edges
  std::size_t broken = 0;  // vertices whose two edges have different lengths
};

/// Only for vertices where no loop begins and no loops meet.
Joints joints_at(const Layer& layer, Level level) {
  std::map<std::uint32_t, std::vector<double>> along;  // by vertex
  for (const std::uint32_t edge : edges_at(layer, level)) {
    const AlongEdge lengths = along_edge(layer.mesh(), layer.outline(), edge, level);
    const double stretched = std::abs(lengths.lower - lengths.upper);
    const double length = length_of(layer, edge);
    EXPECT_GE(stretched, 0.75 * length - 2) << "edge " << edge;
    EXPECT_LE(stretched, 8 * length + 2) << "edge " << edge;
    along[layer.mesh().edges[edge].upper].push_back(lengths.upper);
    along[layer.mesh().edges[edge].lower].push_back(lengths.lower);
  }
  Joints joints;
  for (const auto& [vertex, lengths] : along) {
    if (layer.outline().milestone(vertex, level) == 0) continue;
    EXPECT_EQ(lengths.size(), 2u) << "vertex " << vertex;
    ++joints.count;
    joints.broken += lengths.front() != lengths.back();
  }
  return joints;
}

TEST(OutlineTest, LengthsGoOnFromEdgeToEdge) {
  Joints all;
  for (unsigned seed = 0; seed < 140; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const auto layer = layer_of_polygon(random_shape(seed));
    EXPECT_EQ(joints_at(*layer, 0).broken, 0u);
    for (int level = 1; level <= kLastLevel; ++level) {
      const Joints joints = joints_at(*layer, static_cast<Level>(level));
      all.count += joints.count;
      all.broken += joints.broken;
    }
  }
  EXPECT_LT(all.broken, all.count / 100) << "of " << all.count;
}

TEST(OutlineTest, LengthsOfARoughCoastGoOnAtAllTolerances) {
  const auto layer = layer_of_polygon(rough_coast(7));
  for (int level = 0; level <= kLastLevel; ++level) {
    const Joints joints = joints_at(*layer, static_cast<Level>(level));
    EXPECT_LE(joints.broken, joints.count / 200) << "level " << level << ", of " << joints.count;
  }
}

TEST(OutlineTest, LengthsAreThoseThatAreDrawnAtTheTolerancesOfZooms) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const auto layer = layer_of_polygon(rough_coast(seed));
    double first = 0;
    double last = 0;
    for (int level = 0; level <= kLastLevel; level = level == 0 ? 1 : level + kLevelsPerOctave) {
      double drawn = 0;
      double along = 0;
      const std::set<std::uint32_t> edges = edges_at(*layer, static_cast<Level>(level));
      if (edges.size() < 16) break;
      for (const std::uint32_t edge : edges) {
        const AlongEdge lengths =
            along_edge(layer->mesh(), layer->outline(), edge, static_cast<Level>(level));
        drawn += length_of(*layer, edge);
        along += std::abs(lengths.lower - lengths.upper);
      }
      EXPECT_NEAR(along / drawn, 1, 0.07) << "seed " << seed << ", level " << level;
      if (level == 0) first = drawn;
      last = drawn;
    }
    EXPECT_LT(last, 0.7 * first) << "there was nothing to note anew";
  }
}

TEST(OutlineTest, WhatIsNotThereHasNoMilestones) {
  const OutlineView none;
  EXPECT_EQ(none.milestone(7, 3), 0u);
  EXPECT_EQ(none.loop_size(7), kLoopSizes - 1);
}

}  // namespace
}  // namespace trapeze
