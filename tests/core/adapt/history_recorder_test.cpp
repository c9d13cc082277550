#include "core/adapt/history_recorder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "core/layer/dust.h"
#include "core/layer/layer_builder.h"
#include "core/mesh/mesh_index.h"
#include "core/sweep/graph_builder.h"
#include "tests/core/shapes/drawn_trapezoids.h"
#include "tests/core/shapes/shapes.h"

namespace trapeze {
namespace {

TEST(History, LifespansGiveTheTrapezoidsOfAdaptingAtEveryLevel) {
  for (unsigned seed = 0; seed < 210; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    for (const Topology topology : {Topology::strict, Topology::fast}) {
      GraphBuilder builder;
      TrapezoidalGraph graph;
      Rings rings = random_shape(seed);
      if (!builder.build(rings, graph).built) continue;
      const GeneralizationOptions options{WeightRule::douglas_peucker, topology};
      AdaptableGraph adaptable(graph, options);
      History history;
      HistoryRecorder recorder;
      recorder.record(graph, options, history);
      for (int level = 0; level <= kLastLevel; ++level) {
        adaptable.adapt_to(epsilon_of_level(static_cast<Level>(level)));
        ASSERT_EQ(alive_at(history, static_cast<Level>(level)),
                  inside_of(adaptable.graph(), FaceFeatures({0})))
            << "level " << level;
      }
    }
  }
}

using Segment = std::array<std::int32_t, 4>;

Segment segment(Point a, Point b) {
  return {a.x, a.y, b.x, b.y};
}

std::set<Segment> boundary_of(const TrapezoidalGraph& g) {
  std::set<Segment> segments;
  for (std::size_t e = 0; e < g.edges().size(); ++e) {
    const Edge& edge = g.edge(EdgeId(e));
    if (!edge.is_alive() || g.is_frame(EdgeId(e))) continue;
    segments.insert(segment(g.point(edge.end[kUp]), g.point(edge.end[kDown])));
  }
  return segments;
}

std::set<Segment> boundary_at(const History& h, Level level) {
  std::set<Segment> segments;
  const auto add = [&](std::uint32_t e) {
    segments.insert(segment(h.vertices[h.edges[e].upper], h.vertices[h.edges[e].lower]));
  };
  for (std::size_t i = 0; i < h.trapezoids.size(); ++i) {
    if (!h.lifespans[i].contains(level)) continue;
    add(h.trapezoids[i].left);
    add(h.trapezoids[i].right);
  }
  for (const HorizontalEdge& horizontal_edge : h.horizontal_edges) {
    if (!horizontal_edge.lifespan.contains(level)) continue;
    const MeshEdge& edge = h.edges[horizontal_edge.edge];
    EXPECT_EQ(h.vertices[edge.upper].y, h.vertices[edge.lower].y);
    add(horizontal_edge.edge);
  }
  return segments;
}

TEST(History, SidesOfTrapezoidsAndHorizontalEdgesAreTheWholeBoundaryAtEveryLevel) {
  std::size_t horizontal_edges = 0;
  for (unsigned seed = 0; seed < 140; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    GraphBuilder builder;
    TrapezoidalGraph graph;
    Rings rings = random_shape(seed);
    if (!builder.build(rings, graph).built) continue;
    AdaptableGraph adaptable(graph, {});
    History history;
    HistoryRecorder().record(graph, {}, history);
    horizontal_edges += history.horizontal_edges.size();
    for (int level = 0; level <= kLastLevel; ++level) {
      adaptable.adapt_to(epsilon_of_level(static_cast<Level>(level)));
      ASSERT_EQ(boundary_at(history, static_cast<Level>(level)), boundary_of(adaptable.graph()))
          << "level " << level;
    }
  }
  EXPECT_GT(horizontal_edges, 100U);
}

// Rings of spikes that reach from the middle to a circle: each ring lies beside all rings that
// begin farther out.
Rings star(std::size_t rays) {
  Rings rings;
  for (std::size_t i = 0; i < 2 * rays; ++i) {
    const double angle = 3.141592653589793 * static_cast<double>(i) / static_cast<double>(rays);
    const double radius = i % 2 == 0 ? 1e8 : 1e7;
    rings.points.push_back({static_cast<std::int32_t>(radius * std::cos(angle)),
                            static_cast<std::int32_t>(radius * std::sin(angle))});
  }
  rings.close_ring();
  return rings;
}

TEST(History, EndsEarlyWhereEveryRemovalChangesThousandsOfTrapezoids) {
  GraphBuilder builder;
  TrapezoidalGraph graph;
  Rings rings = star(60'000);
  ASSERT_TRUE(builder.build(rings, graph).built);
  History history;
  HistoryRecorder recorder;
  const std::optional<double> reached = recorder.record(graph, {}, history);
  ASSERT_TRUE(reached);
  EXPECT_GT(*reached, 0);
  const PriorityStack::Counts& counts = recorder.stack().counts();
  EXPECT_GT(counts.removals, 1000U);
  // The last removal is the one that exceeded the limit.
  EXPECT_LT(counts.touched + counts.walked,
            HistoryRecorder::most_work(120'000) + graph.nodes().size());
  // The coarsest level shows the polygon that the graph has reached.
  EXPECT_EQ(boundary_at(history, kLastLevel), boundary_of(graph));
  EXPECT_GT(boundary_of(graph).size(), 1000U);
}

TEST(History, OutlinesOfAllKindsAreSimplifiedToTheEnd) {
  for (unsigned seed = 0; seed < 70; ++seed) {
    GraphBuilder builder;
    TrapezoidalGraph graph;
    Rings rings = random_shape(seed);
    if (!builder.build(rings, graph).built) continue;
    History history;
    EXPECT_FALSE(HistoryRecorder().record(graph, {}, history)) << "seed " << seed;
  }
}

TEST(History, NoVersionLivesForNoTime) {
  for (unsigned seed = 0; seed < 70; ++seed) {
    GraphBuilder builder;
    TrapezoidalGraph graph;
    Rings rings = random_shape(seed);
    if (!builder.build(rings, graph).built) continue;
    History history;
    HistoryRecorder().record(graph, {}, history);
    for (const Lifespan life : history.lifespans)
      EXPECT_LT(life.born, life.dies) << "seed " << seed;
  }
}

TEST(History, RecordingAfterOthersIsTheSameAsAlone) {
  HistoryRecorder used;
  History both;
  History alone;
  for (unsigned seed = 0; seed < 2; ++seed) {
    GraphBuilder builder;
    TrapezoidalGraph graph;
    Rings rings = random_shape(seed);
    ASSERT_TRUE(builder.build(rings, graph).built);
    TrapezoidalGraph copy = graph;
    used.record(graph, {}, both);
    if (seed == 1) HistoryRecorder().record(copy, {}, alone);
  }
  const std::size_t first = both.trapezoids.size() - alone.trapezoids.size();
  EXPECT_TRUE(std::equal(both.lifespans.begin() + static_cast<std::ptrdiff_t>(first),
                         both.lifespans.end(), alone.lifespans.begin(), alone.lifespans.end()));
}

TEST(History, SquareLeavesAGrainOfItsArea) {
  GraphBuilder builder;
  TrapezoidalGraph graph;
  Rings rings = rings_from_text("0 0, 100 0, 100 100, 0 100");
  ASSERT_TRUE(builder.build(rings, graph).built);
  History history;
  HistoryRecorder().record(graph, {}, history);
  ASSERT_EQ(history.grains.size(), 1u);
  EXPECT_EQ(history.grains[0].area, 10000);
  // The corners off the diagonal weigh half a diagonal, 70.7 cells.
  EXPECT_EQ(history.grains[0].born, level_above(70.7));
}

TEST(History, HoleLeavesAGrainOfNegativeArea) {
  GraphBuilder builder;
  TrapezoidalGraph graph;
  Rings rings =
      rings_from_text("0 0, 1000 0, 1000 1000, 0 1000; 400 400, 410 400, 410 410, 400 410");
  ASSERT_TRUE(builder.build(rings, graph).built);
  History history;
  HistoryRecorder().record(graph, {}, history);
  ASSERT_EQ(history.grains.size(), 2u);
  EXPECT_EQ(history.grains[0].area, -100);
  EXPECT_EQ(history.grains[1].area, 1000000);
}

TEST(Dust, AreaOfMotesIsThatOfTheGrainsAtEveryLevel) {
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int32_t> at(-100000, 100000);
  std::uniform_int_distribution<int> born(1, 40);
  std::uniform_real_distribution<double> area(-50, 300);
  std::vector<Grain> grains;
  for (int i = 0; i < 3000; ++i) {
    const Point p{at(random), at(random)};
    const Point q{p.x + at(random) / 100, p.y + at(random) / 100};
    grains.push_back({{p, q}, area(random) * 1000, static_cast<Level>(born(random))});
  }
  const std::vector<Mote> motes = settle(grains, 3 * grains.size());
  for (int level = 0; level <= kLastLevel; ++level) {
    double want = 0;
    for (const Grain& g : grains) want += g.born <= level ? g.area : 0;
    double have = 0;
    for (const Mote& m : motes) have += m.lifespan.contains(static_cast<Level>(level)) ? m.area : 0;
    EXPECT_NEAR(have, want, 1 + 1e-9 * std::abs(want)) << "level " << level;
  }
}

TEST(Dust, MotesAliveTogetherAreBoundedByPixels) {
  std::mt19937 random(8);
  std::uniform_int_distribution<std::int32_t> at(0, 4095);
  std::vector<Grain> grains;
  for (int i = 0; i < 20000; ++i) {
    const Point p{at(random), at(random)};
    grains.push_back({{p, p}, 10, 1});
  }
  const std::vector<Mote> motes = settle(grains, 3 * grains.size());
  for (int level = 1; level <= kLastLevel; level += kLevelsPerOctave) {
    const double pixel = pixel_of_level(static_cast<Level>(level));
    const auto alive = std::count_if(motes.begin(), motes.end(), [&](const Mote& m) {
      return m.lifespan.contains(static_cast<Level>(level));
    });
    EXPECT_LE(static_cast<double>(alive), std::pow(std::ceil(4096 / pixel), 2))
        << "level " << level;
  }
}

TEST(Dust, LongGrainsHaveManyMotesOnlyWhereTheyAreFew) {
  const Grain sliver{{{0, 0}, {1'000'000, 500'000}}, 4e6, 1};
  std::vector<Grain> grains(200, sliver);
  EXPECT_EQ(most_motes_of(grains, 600), kMostMotes);
  grains.resize(20'000, sliver);
  EXPECT_EQ(most_motes_of(grains, 60'000), 8);
  EXPECT_EQ(most_motes_of(grains, 2'000'000), kMostMotes) << "once they had many vertices";
  // The slivers of a pixel share one mote in any case.
  grains.assign(1'000'000, {{{0, 0}, {1, 1}}, 4, 1});
  grains.resize(1'000'200, sliver);
  EXPECT_EQ(most_motes_of(grains, 3'000'600), kMostMotes);
}

TEST(Dust, FewerMotesHaveTheSameArea) {
  const std::vector<Grain> grains(20'000, {{{0, 0}, {1'000'000, 500'000}}, 4e6, 1});
  double area = 0;
  for (const Mote& mote : settle(grains, 60'000)) {
    if (mote.lifespan.contains(kLastLevel)) area += mote.area;
  }
  EXPECT_NEAR(area / (20'000 * 4e6), 1, 1e-9);
}

TEST(Dust, MotesAtTheEdgesOfTheGridKeepTheirArea) {
  for (const double x : {double{kGridMin}, 0.0, double{kGridMax}}) {
    for (const double y : {double{kGridMin}, 0.0, double{kGridMax}}) {
      const Box box = box_of_mote(x, y, 1e6);
      EXPECT_EQ(box.max_x - box.min_x, 1000);
      EXPECT_EQ(box.max_y - box.min_y, 1000);
      EXPECT_TRUE(box.min_x >= kGridMin && box.max_x <= kGridMax);
      EXPECT_TRUE(box.min_y >= kGridMin && box.max_y <= kGridMax);
    }
  }
}

TEST(Layer, DustOfAGreatToleranceIsMotesWithinPixelsAndLaterBirthsBeyond) {
  // Two squares of ten cells, twenty apart: both are gone at a tolerance of 64, in one pixel of 64
  // cells, but in different pixels of 8 cells.
  std::vector<LayerBuilder> builders(1);
  FeatureTable features(std::vector<Field>{});
  Rings first = rings_from_text("0 0, 10 0, 10 10, 0 10");
  Rings second = rings_from_text("30 0, 40 0, 40 10, 30 10");
  builders[0].add(features.append(0, {}), first);
  builders[0].add(features.append(1, {}), second);
  const auto layer = LayerBuilder::join(builders, std::move(features));
  const auto count = [&](double epsilon, double pixel, SmallPolygons small) {
    std::vector<TrapezoidRange> ranges;
    layer->select({layer->bounds(), nearest_level(epsilon), nearest_level(pixel / 4), small},
                  ranges);
    std::uint32_t sum = 0;
    for (const TrapezoidRange& range : ranges) sum += range.count;
    return sum;
  };
  EXPECT_EQ(count(64, 64, SmallPolygons::dust), 1u);
  EXPECT_EQ(count(64, 8, SmallPolygons::dust), 0u);
  const auto count_later = [&](double epsilon, double pixel) {
    const Layer::Selection selection{layer->bounds(), nearest_level(epsilon),
                                     nearest_level(pixel / 4), SmallPolygons::dust};
    int later = 0;
    layer->grains().visit(layer->bounds(), selection.later_births(),
                          [&later](const FeatureGrain&) { ++later; });
    return later;
  };
  EXPECT_EQ(count_later(64, 8), 2);
  EXPECT_EQ(count_later(16, 64), 0);
  EXPECT_EQ(count(64, 64, SmallPolygons::drop), 0u);
  EXPECT_EQ(count(64, 64, SmallPolygons::keep), 0u);
  std::vector<Box> places;
  layer->small_polygons({layer->bounds(), nearest_level(64), nearest_level(16)}, places);
  EXPECT_EQ(places.size(), 1u);
}

TEST(LayerBuilder, LayerDoesNotDependOnWhichBuilderGotWhat) {
  const auto layer_of = [](int builder_count) {
    std::vector<LayerBuilder> builders(static_cast<std::size_t>(builder_count));
    FeatureTable features(std::vector<Field>{});
    for (unsigned seed = 0; seed < 60; ++seed) {
      const std::uint32_t row = features.append(seed, {});
      Rings rings = random_shape(seed);
      builders[seed % builders.size()].add(row, rings);
    }
    return LayerBuilder::join(builders, std::move(features));
  };
  const auto one = layer_of(1);
  const auto many = layer_of(4);
  EXPECT_TRUE(std::ranges::equal(one->mesh().vertices, many->mesh().vertices));
  EXPECT_TRUE(std::ranges::equal(one->mesh().edges, many->mesh().edges));
  EXPECT_TRUE(std::ranges::equal(one->mesh().trapezoids, many->mesh().trapezoids));
}

TEST(Layer, SelectionOfAPartHoldsEverythingThatTouchesIt) {
  std::vector<LayerBuilder> builders(1);
  FeatureTable features(std::vector<Field>{});
  for (unsigned seed = 0; seed < 100; ++seed) {
    Rings rings = random_shape(seed);
    builders[0].add(features.append(seed, {}), rings);
  }
  const auto layer = LayerBuilder::join(builders, std::move(features));
  std::mt19937 random(3);
  std::uniform_int_distribution<std::int32_t> at(-12000, 12000);
  std::vector<TrapezoidRange> all;
  std::vector<TrapezoidRange> part;
  const auto ids = [](const std::vector<TrapezoidRange>& ranges) {
    std::vector<std::uint32_t> found;
    for (const auto& r : ranges) {
      for (std::uint32_t i = 0; i < r.count; ++i) found.push_back(r.first + i);
    }
    return found;
  };
  for (int i = 0; i < 200; ++i) {
    const Level level = static_cast<Level>(i % 20);
    Box box;
    box.include(Point{at(random), at(random)});
    box.include(Point{at(random) / (1 + i % 9), at(random) / (1 + i % 9)});
    layer->select({layer->bounds(), level}, all);
    layer->select({box, level}, part);
    const auto selected = ids(part);
    EXPECT_TRUE(std::is_sorted(selected.begin(), selected.end()));
    for (const std::uint32_t t : ids(all)) {
      if (!box_of(layer->mesh(), layer->mesh().trapezoids[t]).intersects(box)) continue;
      EXPECT_TRUE(std::binary_search(selected.begin(), selected.end(), t));
    }
  }
}

}  // namespace
}  // namespace trapeze
