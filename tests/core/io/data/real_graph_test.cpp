// Graphs of real polygons: exact areas, reverted removals, random jumps, and lifespans, file by
// file.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "core/adapt/adaptable_graph.h"
#include "core/adapt/history_recorder.h"
#include "core/graph/check_graph.h"
#include "core/io/source/feature_source.h"
#include "core/io/source/source_ring_reader.h"
#include "core/sweep/graph_builder.h"

namespace trapeze {
namespace {

// All large features are tested, and a sample of the small ones spread over the file.
constexpr std::size_t kLargeFeature = 2000;  // points
constexpr std::size_t kSampledFeatures = 60;
constexpr int kJumpsPerFeature = 20;
constexpr std::size_t kMaxRingsToNest = 300;

Int128 doubled_area_of_ring(std::span<const Point> ring) {
  Int128 sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point a = ring[i];
    const Point b = ring[(i + 1) % ring.size()];
    sum += static_cast<Int128>(a.x) * b.y - static_cast<Int128>(b.x) * a.y;
  }
  return sum;
}

/// By the parity of the edges to the right; exact.
bool is_inside(Point p, std::span<const Point> ring) {
  bool inside = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Point a = ring[i];
    Point b = ring[(i + 1) % ring.size()];
    if (a.y > b.y) std::swap(a, b);
    if (a.y <= p.y && p.y < b.y && orientation(a, b, p) > 0) inside = !inside;
  }
  return inside;
}

/// For rings that neither cross nor touch: the sign of each depends on how many others contain it.
Int128 area_by_nesting(const Rings& rings) {
  Int128 sum = 0;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const Int128 doubled = doubled_area_of_ring(rings[r]);
    std::size_t depth = 0;
    for (std::size_t other = 0; other < rings.size(); ++other) {
      if (other != r) depth += is_inside(rings[r].front(), rings[other]);
    }
    sum += (depth % 2 == 0) == (doubled > 0) ? doubled : -doubled;
  }
  return sum;
}

/// Identifies a set of trapezoids in any order: their number, and the sum of their hashes.
struct Fingerprint {
  std::size_t count = 0;
  std::uint64_t sum = 0;

  void add(std::int32_t top, std::int32_t bottom, Point lu, Point ll, Point ru, Point rl) {
    if (top == bottom) return;  // no area: never stored
    std::uint64_t hash = 0x9e3779b97f4a7c15u;
    for (const std::int32_t v : {top, bottom, lu.x, lu.y, ll.x, ll.y, ru.x, ru.y, rl.x, rl.y}) {
      hash = (hash ^ static_cast<std::uint32_t>(v)) * 0xff51afd7ed558ccdu;
      hash ^= hash >> 32;
    }
    ++count;
    sum += hash;
  }
  friend bool operator==(const Fingerprint&, const Fingerprint&) = default;
};

Fingerprint fingerprint_of(const TrapezoidalGraph& g) {
  Fingerprint print;
  for (const Node& n : g.nodes()) {
    if (!n.is_alive() || g.face(n) == kOutside) continue;
    const auto at = [&](Side s, Direction d) { return g.point(g.edge(n.edge[s]).end[d]); };
    print.add(g.point(n.end[kUp]).y, g.point(n.end[kDown]).y, at(kLeft, kUp), at(kLeft, kDown),
              at(kRight, kUp), at(kRight, kDown));
  }
  return print;
}

Fingerprint fingerprint_of(const History& h, Level level) {
  Fingerprint print;
  for (std::size_t i = 0; i < h.trapezoids.size(); ++i) {
    if (!h.lifespans[i].contains(level)) continue;
    const MeshTrapezoid& t = h.trapezoids[i];
    const auto at = [&](std::uint32_t v) { return h.vertices[v]; };
    print.add(at(t.top).y, at(t.bottom).y, at(h.edges[t.left].upper), at(h.edges[t.left].lower),
              at(h.edges[t.right].upper), at(h.edges[t.right].lower));
  }
  return print;
}

void expect_exact_area(const TrapezoidalGraph& graph, const Rings& rings) {
  if (rings.size() > kMaxRingsToNest) return;
  EXPECT_TRUE(graph.doubled_area() == area_by_nesting(rings)) << "the areas differ";
}

void expect_area_of_orientation(const TrapezoidalGraph& graph, const Rings& rings) {
  Int128 sum = 0;
  for (std::size_t r = 0; r < rings.size(); ++r) sum += doubled_area_of_ring(rings[r]);
  EXPECT_TRUE(graph.doubled_area() == (sum < 0 ? -sum : sum)) << "the areas differ";
}

void expect_the_way_back(const TrapezoidalGraph& graph) {
  AdaptableGraph adaptable(graph);
  adaptable.adapt_to(std::numeric_limits<double>::infinity());
  adaptable.adapt_to(0);
  EXPECT_TRUE(adaptable.graph() == graph) << "forward and back is another graph";
}

void expect_jumps_to_lead_where_going_straight_does(const TrapezoidalGraph& graph, unsigned seed) {
  AdaptableGraph wandering(graph);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> exponent(-2, 20);
  for (int jump = 0; jump < kJumpsPerFeature; ++jump) {
    const double epsilon = std::exp2(exponent(random));
    wandering.adapt_to(epsilon);
    AdaptableGraph straight(graph);
    straight.adapt_to(epsilon);
    ASSERT_TRUE(wandering.graph() == straight.graph()) << "at " << epsilon;
  }
}

void expect_lifespans_to_equal_adapting(TrapezoidalGraph graph) {
  AdaptableGraph adaptable(graph);
  History history;
  HistoryRecorder().record(graph, {}, history);
  for (int level = 0; level <= kLastLevel; ++level) {
    adaptable.adapt_to(epsilon_of_level(static_cast<Level>(level)));
    ASSERT_TRUE(fingerprint_of(history, static_cast<Level>(level)) ==
                fingerprint_of(adaptable.graph()))
        << "at level " << level;
  }
}

class RealGraphTest : public ::testing::TestWithParam<const char*> {};

TEST_P(RealGraphTest, AreasAreExactAndEveryWayLeadsToTheSameGraph) {
  const char* folder = std::getenv("TRAPEZE_DATA");
  if (folder == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
  const std::filesystem::path path = std::filesystem::path(folder) / GetParam();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  FeatureSource source(path.string());
  SourceRingReader reader(source);
  std::vector<Rings> features;
  for (SourceFeature next; source.next(next);) {
    const OGRGeometry* geometry = next.feature->GetGeomFieldRef(next.layer->geometry_field);
    if (geometry == nullptr || !has_polygons(*geometry)) continue;
    features.push_back(reader.read(*geometry, next.layer_index).rings);
  }
  const std::size_t stride = features.size() / kSampledFeatures + 1;
  std::size_t exact = 0;
  GraphBuilder builder;
  for (std::size_t i = 0; i < features.size(); ++i) {
    SCOPED_TRACE("feature " + std::to_string(i));
    const bool is_large = features[i].points.size() > kLargeFeature;
    TrapezoidalGraph graph;
    const BuildOutcome outcome = builder.build(features[i], graph);
    ASSERT_EQ(outcome.failure, "");
    if (!outcome.built) continue;
    // Noded features have other rings than the input, and nesting says little about rings that
    // touch. For these the sum over all edges, which check_graph computes, has to do.
    const bool is_as_it_came = !outcome.noded && graph.vertex_count() == features[i].points.size();
    EXPECT_EQ(check_graph(graph), "");
    if (is_as_it_came) expect_exact_area(graph, features[i]);
    // The giants have holes that touch; their shells run one way, their holes the other.
    if (!outcome.noded && is_large) expect_area_of_orientation(graph, features[i]);
    ++exact;
    if (!is_large && i % stride != 0) continue;
    expect_the_way_back(graph);
    expect_lifespans_to_equal_adapting(graph);
    if (!is_large) expect_jumps_to_lead_where_going_straight_does(graph, static_cast<unsigned>(i));
  }
  EXPECT_GT(exact, 0u);
}

INSTANTIATE_TEST_SUITE_P(
    Files, RealGraphTest,
    ::testing::Values("shenzhen_buildings.fgb", "shenzhen_water.fgb", "malta_buildings.fgb",
                      "malta_natural.fgb", "malta_landuse.fgb", "melbourne_natural.fgb",
                      "melbourne_landuse.fgb", "kobroor.fgb", "us_counties.fgb",
                      "lands_complex.fgb", "usa48_land.fgb", "europe_countries.fgb",
                      "awkward/earcut.geojson", "awkward/poly2tri.geojson",
                      "awkward/geos_validity.geojson"),
    [](const auto& test) { return std::filesystem::path(test.param).stem().string(); });

}  // namespace
}  // namespace trapeze
