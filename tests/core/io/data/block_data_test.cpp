// Land use polygons of real places become blocks of one use each.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/adapt/adaptable_graph.h"
#include "core/borders/coverage_groups.h"
#include "core/graph/check_graph.h"
#include "core/io/source/merge_classes.h"
#include "core/layer/layer_options.h"
#include "core/sweep/clean_rings.h"
#include "tests/core/io/data/source_rings.h"

namespace trapeze {
namespace {

/// For the features that have polygons.
std::vector<std::uint64_t> classes_of_source(const std::string& path,
                                             const std::string& attribute) {
  FeatureSource source(path);
  MergeClasses reader(source, attribute);
  std::vector<std::uint64_t> classes;
  SourceFeature next;
  while (source.next(next)) classes.push_back(reader.class_of(next));
  return classes;
}

TEST(BlockDataTest, LandBecomesBlocksWithinAClassAndNeverAcross) {
  const char* data = std::getenv("TRAPEZE_DATA");
  if (data == nullptr) GTEST_SKIP() << "TRAPEZE_DATA does not name a folder of real data";
  const std::string path = (std::filesystem::path(data) / "malta_landuse.fgb").string();
  std::vector<Rings> features = testing::rings_of_source(path);
  const std::vector<std::uint64_t> classes = classes_of_source(path, "type");
  ASSERT_EQ(features.size(), classes.size());
  std::vector<const Rings*> pointers;
  for (Rings& rings : features) {
    clean_rings(rings);
    pointers.push_back(&rings);
  }
  LayerOptions options;
  options.merge = 4;
  CoverageBuilder builder;
  TrapezoidalGraph graph;
  const Assembly assembly =
      assemble(pointers, options.coverage, 0, builder, graph, nullptr, 1, options.merging(classes));
  ASSERT_TRUE(assembly.outcome.plan.has_value());
  const MergePlan& plan = *assembly.outcome.plan;
  EditLog log(graph);
  PriorityStack stack;
  stack.assign(graph, {}, 1, &plan);
  std::size_t joined = 0;
  while (const auto epsilon = stack.remove_next(graph, log)) {
    if (*epsilon > testing::epsilon_of_zoom(11)) break;
    const bool is_block =
        stack.last_removal() == Removal::region && stack.last_block_size().has_value();
    if (is_block) {
      for (const auto& kept : log.touched_edges()) {
        const Edge& edge = graph.edge(kept.id);
        for (const Side s : {kLeft, kRight}) {
          const FaceId before = kept.record.face[s];
          if (!edge.is_alive() || edge.face[s] == before || plan.is_void(before)) continue;
          ASSERT_TRUE(plan.are_of_one_class(before, edge.face[s])) << before;
          ++joined;
        }
      }
    }
    log.forget();
  }
  EXPECT_GT(joined, 1000u);
  EXPECT_EQ(check_graph(graph), "");
}

}  // namespace
}  // namespace trapeze
