// Real coverages stay coverages at every zoom and at arbitrary tolerances.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "core/adapt/adaptable_graph.h"
#include "core/borders/coverage_builder.h"
#include "core/borders/coverage_groups.h"
#include "core/borders/polygons.h"
#include "core/borders/regions.h"
#include "core/graph/check_graph.h"
#include "core/io/load/load_layer.h"
#include "core/sweep/clean_rings.h"
#include "tests/core/io/data/geos_validity.h"
#include "tests/core/io/data/source_rings.h"
#include "tests/core/shapes/same_layers.h"

namespace trapeze {
namespace {

using testing::epsilon_of_zoom;
using testing::GeosValidity;
using testing::rings_of_source;

// GEOS compares every hole of a polygon with every other: minutes for ten thousands.
constexpr std::size_t kMaxFaceHolesForGeos = 500;

/// Those of all zooms, and ten that belong to no zoom, in ascending order.
std::vector<double> tolerances() {
  std::vector<double> epsilons;
  for (int zoom = 0; zoom <= 22; ++zoom) epsilons.push_back(epsilon_of_zoom(zoom));
  for (const double odd : {0.3, 1.7, 23.0, 111.1, 1234.5, 7777.7, 54321.0, 3e5, 2.2e6, 1.9e7}) {
    epsilons.push_back(odd);
  }
  std::sort(epsilons.begin(), epsilons.end());
  return epsilons;
}

/// A directed edge of a ring.
using Step = std::tuple<std::int32_t, std::int32_t, std::int32_t, std::int32_t>;

Step step(Point a, Point b) {
  return {a.x, a.y, b.x, b.y};
}

/// Bounded regions that no feature covers.
std::size_t count_holes(const TrapezoidalGraph& graph) {
  const Regions regions(graph);
  return static_cast<std::size_t>(std::count(regions.face.begin(), regions.face.end(), kOutside)) -
         1;
}

class CoverageTrial {
 public:
  explicit CoverageTrial(TrapezoidalGraph graph)
      : holes_(count_holes(graph)), adaptable_(std::move(graph)) {}

  void run() {
    for (const double epsilon : tolerances()) {
      SCOPED_TRACE("tolerance " + std::to_string(epsilon));
      adaptable_.adapt_to(epsilon);
      judge(epsilon);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }

 private:
  void judge(double epsilon) {
    const TrapezoidalGraph& graph = adaptable_.graph();
    ASSERT_EQ(check_graph(graph), "");
    EXPECT_LE(count_holes(graph), holes_) << "there are holes that the source has not";
    const std::vector<Polygons> faces = polygons_of_faces(graph);
    std::vector<Step> steps;
    Int128 sum = 0;
    std::size_t parts = 0;
    for (const Polygons& polygons : faces) {
      EXPECT_FALSE(polygons.is_noded);
      parts += polygons.size();
      judge_validity(polygons);
      for (std::size_t r = 0; r < polygons.rings.size(); ++r) {
        const auto ring = polygons.rings[r];
        for (std::size_t i = 0; i < ring.size(); ++i) {
          const Point a = ring[i];
          const Point b = ring[(i + 1) % ring.size()];
          steps.push_back(step(a, b));
          sum += Int128{a.x} * b.y - Int128{b.x} * a.y;
        }
      }
    }
    EXPECT_TRUE((sum < 0 ? -sum : sum) == graph.doubled_area()) << "the areas do not add up";
    std::sort(steps.begin(), steps.end());
    EXPECT_EQ(std::adjacent_find(steps.begin(), steps.end()), steps.end())
        << "an edge is used twice in one direction";
    expect_inner_edges_both_ways(graph, steps);
    std::printf("  %10.1f cells: %7zu vertices, %5zu polygons, %5zu holes\n", epsilon,
                count_vertices(graph), parts, count_holes(graph));
  }

  void judge_validity(const Polygons& polygons) const {
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      const std::size_t begin = polygons.first_ring(i);
      if (polygons.ends[i] - begin > kMaxFaceHolesForGeos) continue;
      EXPECT_EQ(geos_.complaint(polygons.rings, begin, polygons.ends[i]), "");
    }
  }

  static void expect_inner_edges_both_ways(const TrapezoidalGraph& graph,
                                           const std::vector<Step>& steps) {
    std::size_t inner = 0;
    std::size_t outer = 0;
    for (std::size_t i = 0; i < graph.edges().size(); ++i) {
      const Edge& edge = graph.edge(EdgeId(i));
      if (!edge.is_alive() || graph.is_frame(EdgeId(i))) continue;
      const Point a = graph.point(edge.end[kUp]);
      const Point b = graph.point(edge.end[kDown]);
      const int uses = std::binary_search(steps.begin(), steps.end(), step(a, b)) +
                       std::binary_search(steps.begin(), steps.end(), step(b, a));
      const bool is_inner = edge.face[kLeft] != kOutside && edge.face[kRight] != kOutside;
      ASSERT_EQ(uses, is_inner ? 2 : 1);
      (is_inner ? inner : outer) += 1;
    }
    EXPECT_EQ(steps.size(), 2 * inner + outer);
  }

  static std::size_t count_vertices(const TrapezoidalGraph& graph) {
    std::vector<VertexId> vertices;
    for (const Corner& corner : graph.corners()) {
      if (corner.is_alive()) vertices.push_back(corner.vertex);
    }
    std::sort(vertices.begin(), vertices.end());
    return static_cast<std::size_t>(std::unique(vertices.begin(), vertices.end()) -
                                    vertices.begin());
  }

  const GeosValidity geos_;
  const std::size_t holes_;
  AdaptableGraph adaptable_;
};

struct CoverageFile {
  const char* name;
  bool is_sample = false;  // in the folder that script/server fills, not in that of TRAPEZE_DATA
};

/// Empty if the file does not exist, with the reason.
std::filesystem::path path_of(const CoverageFile& file, std::string& reason) {
  const char* folder = file.is_sample ? TRAPEZE_SAMPLE : std::getenv("TRAPEZE_DATA");
  if (folder == nullptr) {
    reason = "TRAPEZE_DATA does not name a folder of real data";
    return {};
  }
  const std::filesystem::path path = std::filesystem::path(folder) / file.name;
  if (std::filesystem::exists(path)) return path;
  reason = path.string() + " is not there";
  return {};
}

class CoverageDataTest : public ::testing::TestWithParam<CoverageFile> {};

TEST_P(CoverageDataTest, StaysACoverageAtEveryTolerance) {
  std::string reason;
  const std::filesystem::path path = path_of(GetParam(), reason);
  if (path.empty()) GTEST_SKIP() << reason;
  std::vector<Rings> features = rings_of_source(path.string());
  std::vector<const Rings*> pointers;
  for (Rings& rings : features) {
    clean_rings(rings);
    pointers.push_back(&rings);
  }
  std::size_t grouped = 0;
  for (const auto& group : group_features(pointers, CoverageMode::automatic)) {
    std::vector<const Rings*> members;
    for (const std::uint32_t i : group) members.push_back(pointers[i]);
    TrapezoidalGraph graph;
    const CoverageOutcome outcome = CoverageBuilder().build(members, {.most_overlap = 0.01}, graph);
    ASSERT_EQ(outcome.failure, "");
    ASSERT_TRUE(outcome.built);
    grouped += group.size();
    std::printf(
        "%zu features, %zu vertices, %zu shared edges, %zu junctions, %zu overlaps, %zu gaps\n",
        group.size(), outcome.vertices, outcome.shared_edges, outcome.junctions,
        outcome.overlaps.size(), outcome.gaps);
    CoverageTrial(std::move(graph)).run();
  }
  EXPECT_GT(grouped, features.size() / 4);
}

INSTANTIATE_TEST_SUITE_P(Files, CoverageDataTest,
                         ::testing::Values(CoverageFile{"us_counties.fgb"},
                                           CoverageFile{"europe_countries.fgb"},
                                           CoverageFile{"countries.fgb", true}),
                         [](const auto& test) {
                           return std::filesystem::path(test.param.name).stem().string();
                         });

TEST(RealLayers, AreTheSameWhateverTheNumberOfThreads) {
  const char* folder = std::getenv("TRAPEZE_DATA");
  if (folder == nullptr) GTEST_SKIP() << "TRAPEZE_DATA is not set";
  // Two files with shared borders, and one with a single polygon.
  for (const char* name : {"europe_countries.fgb", "us_counties.fgb", "kobroor.fgb"}) {
    LoadOptions options;
    options.generalization.coverage = CoverageMode::automatic;
    options.threads = 1;
    const std::string path = std::string(folder) + "/" + name;
    const LoadedLayer one = load_layer(path, options);
    EXPECT_EQ(one.report.coverage.groups > 0, one.report.loaded > 1);
    for (const unsigned threads : {2u, 3u, 8u}) {
      SCOPED_TRACE(std::string(name) + " by " + std::to_string(threads));
      options.threads = threads;
      expect_same_layers(*one.layer, *load_layer(path, options).layer);
    }
  }
}

}  // namespace
}  // namespace trapeze
