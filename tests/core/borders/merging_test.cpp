// Polygons that are close to each other become one block.
#include "core/borders/merging.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "core/adapt/adaptable_graph.h"
#include "core/adapt/history_recorder.h"
#include "core/borders/coverage_builder.h"
#include "core/borders/coverage_groups.h"
#include "core/borders/void_mesh.h"
#include "core/graph/check_graph.h"
#include "core/grid/disjoint_sets.h"
#include "core/sweep/clean_rings.h"
#include "tests/core/borders/coverage_shapes.h"
#include "tests/core/shapes/drawn_trapezoids.h"
#include "tests/core/shapes/ring_text.h"

namespace trapeze {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Buildings of random sizes and shapes on both sides of streets, rotated by an angle.
std::vector<Rings> town(unsigned seed, int houses, double angle = 0) {
  std::mt19937 random(seed);
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  std::vector<Rings> features;
  const int columns = std::max(1, static_cast<int>(std::sqrt(houses)));
  const double spacing = 1500 + seed % 4 * 150;
  const double cos = std::cos(angle);
  const double sin = std::sin(angle);
  for (int i = 0; i < houses; ++i) {
    const double x = (i % columns) * spacing + between(0, 300);
    const double y = (i / columns) * spacing + between(0, 300);
    const double w = between(400, 1200);
    const double h = between(400, 1200);
    std::vector<std::pair<double, double>> shape = {{0, 0}, {w, 0}, {w, h}, {0, h}};
    const double kind = between(0, 3);
    if (kind < 1) shape = {{0, 0}, {w, 0}, {w, h / 2}, {w / 2, h / 2}, {w / 2, h}, {0, h}};
    const double turn = between(-0.2, 0.2);
    Rings rings;
    const auto add = [&](const std::vector<std::pair<double, double>>& points) {
      std::vector<Point> ring;
      for (const auto& [px, py] : points) {
        const double qx = x + px * std::cos(turn) - py * std::sin(turn);
        const double qy = y + px * std::sin(turn) + py * std::cos(turn);
        ring.push_back({static_cast<std::int32_t>(std::lround(qx * cos - qy * sin)),
                        static_cast<std::int32_t>(std::lround(qx * sin + qy * cos))});
      }
      rings.add(ring);
    };
    add(shape);
    if (kind > 2) {
      add({{w / 4, h / 4}, {w / 2, h / 4}, {w / 2, h / 2}, {w / 4, h / 2}});
    }
    clean_rings(rings);
    features.push_back(std::move(rings));
  }
  return features;
}

struct BuiltTown {
  CoverageOutcome outcome;
  TrapezoidalGraph graph;

  explicit BuiltTown(const std::vector<Rings>& features, const Merging& merging) {
    std::vector<const Rings*> pointers;
    for (const Rings& rings : features) pointers.push_back(&rings);
    const CoverageTolerance tolerance{.most_overlap = kInfinity, .narrowest_overlap = 32};
    outcome = CoverageBuilder().build(pointers, tolerance, graph, nullptr, 1, merging);
    EXPECT_EQ(outcome.failure, "");
    EXPECT_EQ(check_graph(graph), "");
  }
};

/// The void of a town, before it is divided.
struct TownVoid {
  BuiltTown built;
  VoidMesh mesh;
  std::vector<double> distances;

  explicit TownVoid(const std::vector<Rings>& features) : built(features, {}), mesh(built.graph) {
    EXPECT_FALSE(mesh.has_failed());
    const std::vector<std::uint32_t> one_class(built.outcome.faces.face_count() + 1, 0);
    divide_walls_for_bridges(mesh, built.graph, one_class);
    distances = distances_to_fill(mesh, built.graph, one_class);
  }

  Int128 doubled_area_filled(double distance) const {
    Int128 sum = 0;
    for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      if (mesh.is_beyond(t) || distances[t] > distance) continue;
      sum += orientation(mesh.corner(3 * t), mesh.corner(3 * t + 1), mesh.corner(3 * t + 2));
    }
    return sum;
  }

  /// For features that do not overlap: the number of the block that contains each feature.
  std::vector<std::uint32_t> blocks(double distance, std::size_t features) const {
    // Connected filled triangles, and the faces beside them.
    const auto count = static_cast<std::uint32_t>(mesh.triangle_count());
    DisjointSets ties(count + features);
    for (VoidMesh::HalfEdge h = 0; h < 3 * count; ++h) {
      const std::uint32_t t = VoidMesh::triangle_of(h);
      if (distances[t] > distance) continue;
      if (mesh.is_wall(h)) {
        const Edge& edge = built.graph.edge(mesh.edge_of(h));
        ties.tie(t, count + std::max(edge.face[kLeft], edge.face[kRight]) - 1);
      } else if (distances[VoidMesh::triangle_of(mesh.twin(h))] <= distance) {
        ties.tie(t, VoidMesh::triangle_of(mesh.twin(h)));
      }
    }
    std::vector<std::uint32_t> blocks;
    for (std::uint32_t i = 0; i < features; ++i) blocks.push_back(ties.find(count + i));
    return blocks;
  }
};

TEST(VoidMesh, CoversTheVoidByTrianglesWithEmptyCircles) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const BuiltTown built(town(seed, 2 + static_cast<int>(seed) * 3), {});
    VoidMesh mesh(built.graph);
    for (const bool is_divided : {false, true}) {
      if (is_divided) mesh.divide_walls(kWidestBridge);
      ASSERT_FALSE(mesh.has_failed());
      Int128 area = 0;
      for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        if (mesh.is_beyond(t)) continue;
        const std::int64_t doubled =
            orientation(mesh.corner(3 * t), mesh.corner(3 * t + 1), mesh.corner(3 * t + 2));
        ASSERT_GT(doubled, 0);
        area += doubled;
        for (VoidMesh::HalfEdge h = 3 * t; h < 3 * t + 3; ++h) {
          if (mesh.is_wall(h)) continue;
          ASSERT_EQ(mesh.twin(mesh.twin(h)), h);
          ASSERT_EQ(mesh.vertex(mesh.twin(h)), mesh.vertex(VoidMesh::next(h)));
          if (mesh.is_beyond(VoidMesh::triangle_of(mesh.twin(h)))) continue;
          // The circumcircle of the triangle does not contain the opposite corner, except by
          // rounding.
          const auto at = [&](VoidMesh::HalfEdge k) {
            const Point p = mesh.corner(k);
            return std::complex<double>(p.x, p.y);
          };
          const auto a = at(h);
          const auto b = at(VoidMesh::next(h));
          const auto c = at(VoidMesh::before(h));
          const auto d = at(VoidMesh::before(mesh.twin(h)));
          const double angles =
              std::abs(std::arg((a - c) / (b - c))) + std::abs(std::arg((a - d) / (b - d)));
          EXPECT_LE(angles, std::numbers::pi + 1e-6);
        }
      }
      // The interior of the hull: void and polygons.
      Int128 around = 0;
      for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        for (VoidMesh::HalfEdge h = 3 * t; h < 3 * t + 3; ++h) {
          if (!mesh.is_beyond(t) || mesh.vertex(h).value == 0 ||
              mesh.vertex(VoidMesh::next(h)).value == 0) {
            continue;
          }
          const Point p = mesh.corner(h);
          const Point q = mesh.corner(VoidMesh::next(h));
          around += Int128{p.x} * q.y - Int128{q.x} * p.y;
        }
      }
      Int128 polygons = 0;
      for (const VoidMesh::HalfEdge wall : mesh.walls()) {
        const Point p = mesh.corner(wall);
        const Point q = mesh.corner(VoidMesh::next(wall));
        polygons -= Int128{p.x} * q.y - Int128{q.x} * p.y;
      }
      EXPECT_TRUE(-around == area + polygons);
    }
  }
}

TEST(Merging, WhatIsFilledIsTheLargestSetThatBridgesNoMore) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    const TownVoid town_void(town(seed, 20));
    const VoidMesh& mesh = town_void.mesh;
    for (double distance = 40; distance < 4000; distance *= 1.3) {
      // Starts from all triangles and removes those that cannot be filled until nothing changes.
      std::vector<bool> is_filled(mesh.triangle_count());
      for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        std::array<double, 3> sides{};
        double across = kInfinity;
        for (std::uint32_t i = 0; i < 3 && !mesh.is_beyond(t); ++i) {
          sides[i] = mesh.length(3 * t + i);
          if (mesh.is_wall(3 * t + i)) across = std::min(across, mesh.distance_across(3 * t + i));
        }
        std::sort(sides.begin(), sides.end());
        is_filled[t] = !mesh.is_beyond(t) && (across < kInfinity ? across : sides[1]) <= distance;
      }
      for (bool has_changed = true; has_changed;) {
        has_changed = false;
        for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
          for (VoidMesh::HalfEdge h = 3 * t; h < 3 * t + 3 && is_filled[t]; ++h) {
            if (mesh.is_wall(h) || mesh.length(h) <= distance) continue;
            if (is_filled[VoidMesh::triangle_of(mesh.twin(h))]) continue;
            is_filled[t] = false;
            has_changed = true;
          }
        }
      }
      for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        ASSERT_EQ(is_filled[t], town_void.distances[t] <= distance) << distance;
      }
    }
  }
}

double distance_between(Point p, Point a, Point b) {
  const double x = b.x - a.x;
  const double y = b.y - a.y;
  const double along = std::clamp(((p.x - a.x) * x + (p.y - a.y) * y) / (x * x + y * y), 0.0, 1.0);
  return std::hypot(a.x + along * x - p.x, a.y + along * y - p.y);
}

/// For polygons that do not meet.
double distance_between(const Rings& a, const Rings& b) {
  double least = kInfinity;
  for (const auto& [points, walls] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const Point p : points->points) {
      for (std::size_t r = 0; r < walls->size(); ++r) {
        const auto ring = (*walls)[r];
        for (std::size_t i = 0; i < ring.size(); ++i) {
          least = std::min(least, distance_between(p, ring[i], ring[(i + 1) % ring.size()]));
        }
      }
    }
  }
  return least;
}

TEST(Merging, WhatIsNearerIsInOneBlockAndWhatIsFartherIsNot) {
  std::size_t pairs = 0;
  std::size_t near_pairs = 0;
  std::size_t apart_all_the_same = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    const std::vector<Rings> features = town(seed, 25);
    const TownVoid town_void(features);
    if (!town_void.built.outcome.overlaps.empty()) continue;
    std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> apart;
    for (std::uint32_t i = 0; i < features.size(); ++i) {
      for (std::uint32_t k = 0; k < i; ++k) {
        apart.emplace_back(distance_between(features[i], features[k]), i, k);
      }
    }
    for (double distance = 40; distance < 4000; distance *= 1.3) {
      const std::vector<std::uint32_t> blocks = town_void.blocks(distance, features.size());
      DisjointSets near(features.size());
      for (const auto& [least, i, k] : apart) {
        if (least <= distance + 2) near.tie(i, k);
      }
      for (const auto& [least, i, k] : apart) {
        const bool is_one = blocks[i] == blocks[k];
        if (1.1 * least + 2 < distance) {
          ++near_pairs;
          apart_all_the_same += !is_one;
        }
        if (2 * least < distance) {
          ++pairs;
          EXPECT_TRUE(is_one) << i << " and " << k << ", " << least << " apart, at " << distance;
        }
        if (is_one) {
          EXPECT_EQ(near.find(i), near.find(k));
        }
      }
    }
  }
  EXPECT_GT(pairs, 1000u);
  EXPECT_LT(static_cast<double>(apart_all_the_same), 0.003 * static_cast<double>(near_pairs));
}

TEST(Merging, AreaThatIsAddedGrowsWithTheDistance) {
  const TownVoid town_void(town(3, 60));
  Int128 before = 0;
  int grown = 0;
  for (int i = 1; i <= 100; ++i) {
    const Int128 now = town_void.doubled_area_filled(i * 40);
    EXPECT_TRUE(now >= before);
    grown += now > before;
    before = now;
  }
  EXPECT_GT(grown, 50);
}

TEST(Merging, BlocksAreTheSameWhenTheTownIsTurned) {
  std::size_t compared = 0;
  double filled = 0;
  double filled_turned = 0;
  std::size_t others = 0;  // places where vertices and feet are rounded differently
  for (unsigned seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    const TownVoid as_is(town(seed, 25));
    const TownVoid turned(town(seed, 25, std::numbers::pi / 6));
    if (!as_is.built.outcome.overlaps.empty() || !turned.built.outcome.overlaps.empty()) continue;
    for (double distance = 40; distance < 4000; distance *= 1.2) {
      const auto same = as_is.blocks(distance, 25);
      const auto fewer = as_is.blocks(distance / 2, 25);
      const auto more = as_is.blocks(distance * 2, 25);
      const auto blocks = turned.blocks(distance, 25);
      for (std::uint32_t i = 0; i < 25; ++i) {
        for (std::uint32_t k = 0; k < i; ++k) {
          ++compared;
          others += (blocks[i] == blocks[k]) != (same[i] == same[k]);
          if (fewer[i] == fewer[k]) {
            EXPECT_EQ(blocks[i], blocks[k]) << distance;
          }
          if (blocks[i] == blocks[k]) {
            EXPECT_EQ(more[i], more[k]) << distance;
          }
        }
      }
      filled += static_cast<double>(as_is.doubled_area_filled(distance));
      filled_turned += static_cast<double>(turned.doubled_area_filled(distance));
    }
  }
  EXPECT_GT(compared, 10000u);
  EXPECT_LT(static_cast<double>(others), 0.005 * static_cast<double>(compared));
  EXPECT_NEAR(filled_turned / filled, 1, 0.01);
}

/// Towns, and polygons that share borders, overlap each other and have gaps.
std::vector<Rings> features_for(unsigned seed) {
  return seed % 2 == 0 ? town(seed, 3 + static_cast<int>(seed)) : WiggledGrid(seed).features();
}

TEST(Merging, EveryStepLeavesASoundGraphAndCanBeUndone) {
  std::size_t blocks = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const BuiltTown built(features_for(seed), {.ratio = 4 + seed % 3 * 6.0});
    if (!built.outcome.plan) continue;
    TrapezoidalGraph graph = built.graph;
    EditLog log(graph);
    PriorityStack stack;
    stack.assign(graph, {}, 1, &*built.outcome.plan);
    while (stack.remove_next(graph, log)) {
      ASSERT_EQ(check_graph(graph), "") << "after " << log.size() << " removals";
      blocks += stack.last_removal() == Removal::region && stack.last_block_size().has_value();
    }
    for (const NodeId n : graph.inside_nodes()) {
      ASSERT_TRUE(built.outcome.plan->is_void(graph.face(graph.node(n)))) << "never goes";
    }
    while (log.applied() > 0) log.revert();
    EXPECT_EQ(graph, built.graph);
  }
  EXPECT_GT(blocks, 300u);
}

TEST(Merging, LifespansGiveTheTrapezoidsOfAdaptingAtEveryLevel) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    BuiltTown built(features_for(seed), {.ratio = 16});
    const MergePlan* plan = built.outcome.plan ? &*built.outcome.plan : nullptr;
    AdaptableGraph adaptable(built.graph, {}, plan);
    History history;
    HistoryRecorder().record(built.graph, built.outcome.faces, {}, history, nullptr, 1, plan);
    for (int level = 0; level <= kLastLevel; ++level) {
      adaptable.adapt_to(epsilon_of_level(static_cast<Level>(level)));
      ASSERT_EQ(alive_at(history, static_cast<Level>(level)),
                inside_of(adaptable.graph(), built.outcome.faces))
          << "level " << level;
    }
  }
}

/// Two buildings of 1000 x 1000 cells, this far apart.
std::vector<Rings> two_houses(std::int32_t gap) {
  std::vector<Rings> houses(2);
  houses[0].add(std::vector<Point>{{0, 0}, {1000, 0}, {1000, 1000}, {0, 1000}});
  houses[1].add(
      std::vector<Point>{{1000 + gap, 0}, {2000 + gap, 0}, {2000 + gap, 1000}, {1000 + gap, 1000}});
  return houses;
}

TEST(Merging, TwoHousesBecomeOneRectangleWhenTheDistanceIsReached) {
  const BuiltTown built(two_houses(160), {.ratio = 16});
  ASSERT_TRUE(built.outcome.plan);
  AdaptableGraph adaptable(built.graph, {}, &*built.outcome.plan);
  adaptable.adapt_to(9.9);
  EXPECT_TRUE(adaptable.graph().doubled_areas()[1] == 2'000'000);
  EXPECT_TRUE(adaptable.graph().doubled_areas()[2] == 2'000'000);
  adaptable.adapt_to(10.1);
  EXPECT_TRUE(adaptable.graph().doubled_areas()[1] == 2 * 2160 * 1000);
  EXPECT_TRUE(adaptable.graph().doubled_areas()[2] == 0);
  EXPECT_EQ(rings_of_features(adaptable.graph(), built.outcome.faces)[0].points.size(), 4u)
      << "corners only";
}

TEST(Merging, TouchingHousesBecomeOneAlthoughThereIsNoVoidToBridge) {
  const BuiltTown built(two_houses(0), {.ratio = 16});
  ASSERT_TRUE(built.outcome.plan);
  AdaptableGraph adaptable(built.graph, {}, &*built.outcome.plan);
  adaptable.adapt_to(7.8);  // an eighth of the width over the ratio
  EXPECT_TRUE(adaptable.graph().doubled_areas()[1] == 2'000'000);
  EXPECT_TRUE(adaptable.graph().doubled_areas()[2] == 2'000'000);
  adaptable.adapt_to(7.9);
  EXPECT_TRUE(adaptable.graph().doubled_areas()[1] == 4'000'000);
  EXPECT_TRUE(adaptable.graph().doubled_areas()[2] == 0);
}

TEST(Merging, TouchingHousesOfTwoClassesAreNotMerged) {
  EXPECT_FALSE(BuiltTown(two_houses(0), {.ratio = 16, .classes = {1, 2}}).outcome.plan);
}

/// Squares of 1000 x 1000 cells, 8 by 4 of them, with streets between them; each a feature, or all
/// of them one.
std::vector<Rings> squares(bool are_one_feature) {
  std::vector<Rings> features(are_one_feature ? 1 : 32);
  for (int i = 0; i < 32; ++i) {
    const std::int32_t x = i % 8 * 1400;
    const std::int32_t y = i / 8 * 1400;
    features[are_one_feature ? 0 : i].add(
        std::vector<Point>{{x, y}, {x + 1000, y}, {x + 1000, y + 1000}, {x, y + 1000}});
  }
  return features;
}

TEST(Merging, AllEdgesOfABlockKnowHowLargeItIs) {
  for (const bool are_one_feature : {false, true}) {
    BuiltTown built(squares(are_one_feature), {.ratio = 16});
    ASSERT_TRUE(built.outcome.plan);
    History history;
    HistoryRecorder().record(built.graph, built.outcome.faces, {}, history, nullptr, 1,
                             &*built.outcome.plan);
    const int level = level_above(400 / 16.0);
    std::size_t edges = 0;
    for (std::size_t i = 0; i < history.trapezoids.size(); ++i) {
      if (!history.lifespans[i].contains(static_cast<Level>(level))) continue;
      for (const std::uint32_t e : {history.trapezoids[i].left, history.trapezoids[i].right}) {
        const LoopSize size = loop_size_of(10'800.0 * 5'200.0);
        EXPECT_LE(history.loop_sizes[e], size) << are_one_feature;
        EXPECT_GE(history.loop_sizes[e] + 2, size) << "smaller by less than a quarter";
        ++edges;
      }
    }
    EXPECT_GE(edges, 2u);
  }
}

TEST(Merging, OfTwoClassesNothingIsBridged) {
  const BuiltTown built(two_houses(160), {.ratio = 16, .classes = {7, 8}});
  EXPECT_FALSE(built.outcome.plan);
}

TEST(Merging, FeaturesOfSeveralClassesAreNumberedByThem) {
  const std::vector<std::uint64_t> classes = {1ull << 60, 3, 1ull << 60, 0};
  EXPECT_EQ(numbered(classes), (std::vector<std::uint32_t>{2, 1, 2, 0}));
  EXPECT_TRUE(numbered({}).empty());
}

/// The area that each feature covers, in cells squared.
std::vector<double> areas_at(const std::vector<Rings>& features, double epsilon) {
  const BuiltTown built(features, {.ratio = 16});
  AdaptableGraph adaptable(built.graph, {}, built.outcome.plan ? &*built.outcome.plan : nullptr);
  adaptable.adapt_to(epsilon);
  std::vector<double> areas;
  for (const Int128 doubled : adaptable.graph().doubled_areas()) {
    areas.push_back(static_cast<double>(doubled) / 2);
  }
  return {areas.begin() + 1, areas.begin() + 1 + static_cast<std::ptrdiff_t>(features.size())};
}

TEST(Merging, GroupsBecomeTheSameBlocksAsAllFeaturesTogether) {
  std::size_t blocks = 0;
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    std::vector<Rings> features = town(seed, 12);
    for (Rings rings : town(seed + 1, 9)) {
      for (Point& p : rings.points) p = {p.x + 40'000, p.y - 3'000};
      features.push_back(std::move(rings));
    }
    std::vector<const Rings*> pointers;
    for (const Rings& rings : features) pointers.push_back(&rings);
    const auto groups = group_for_blocks(pointers);
    ASSERT_EQ(groups.size(), 2u);
    for (const double epsilon : {3.0, 20.0, 64.0, 150.0}) {
      const std::vector<double> together = areas_at(features, epsilon);
      for (const auto& group : groups) {
        std::vector<Rings> members;
        for (const std::uint32_t i : group) members.push_back(features[i]);
        const std::vector<double> apart = areas_at(members, epsilon);
        for (std::size_t i = 0; i < group.size(); ++i) {
          const double area = together[group[i]];
          EXPECT_NEAR(apart[i], area, 0.02 * area) << i << " at " << epsilon;
          blocks += area > 1.5e6;  // larger than any building
        }
      }
    }
  }
  EXPECT_GT(blocks, 10u);
}

TEST(Merging, ACourtyardIsFilledWhenItIsNarrowerThanTheDistance) {
  std::vector<Rings> features = two_houses(100'000);
  features[0].clear();
  features[0].add(std::vector<Point>{{0, 0}, {3000, 0}, {3000, 3000}, {0, 3000}});
  features[0].add(std::vector<Point>{{1000, 1000}, {2000, 1000}, {2000, 1320}, {1000, 1320}});
  const BuiltTown built(features, {.ratio = 16});
  ASSERT_TRUE(built.outcome.plan);
  AdaptableGraph adaptable(built.graph, {}, &*built.outcome.plan);
  adaptable.adapt_to(19.9);
  EXPECT_TRUE(adaptable.graph().doubled_areas()[1] == 2 * (9'000'000 - 320'000));
  adaptable.adapt_to(20.1);
  EXPECT_TRUE(adaptable.graph().doubled_areas()[1] == 2 * 9'000'000);
}

}  // namespace
}  // namespace trapeze
