// The cost of the core per vertex, on polygons like those of maps and on hard ones of growing size,
// and whether it grows faster than allowed.
//
//   core_bench                                     everything, some minutes
//   core_bench --benchmark_filter=buildings        a part
//   TRAPEZE_DATA=folder core_bench                 the FlatGeobuf files of the folder as well
//
// Sweep: sorting the vertices and the plane sweep. Build: the same from rings as they are read,
// with cleaning, noding where necessary, and the loops. Weights: Douglas-Peucker. History: Build
// and all versions for all tolerances, which is all the work for a polygon before it is drawn.
// Cores, for large polygons: History with the number of threads in the name, the share of removals
// done in batches, and the speed-up of removals if every thread had a core, counted by the
// trapezoids that they walk and touch.
//
// Every figure is measured three times; use "min" on a machine with other load. The table at the
// end compares the families at their smallest and their largest size.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/core/polygon_families.h"
#include "bench/core/source_rings.h"
#include "core/adapt/history_recorder.h"
#include "core/adapt/vertex_weight.h"
#include "core/sweep/boundary.h"
#include "core/sweep/graph_builder.h"
#include "core/sweep/trapezoidation.h"

namespace trapeze {
namespace {

using Polygons = std::vector<Rings>;

constexpr const char* kPerVertex = "ns_per_vertex";
constexpr std::size_t kLargePolygon = 50000;  // vertices

std::size_t vertices_of(const Polygons& polygons) {
  std::size_t count = 0;
  for (const Rings& rings : polygons) count += rings.points.size();
  return count;
}

void count_vertices(benchmark::State& state, std::size_t vertices) {
  const double billions =
      1e-9 * static_cast<double>(vertices) * static_cast<double>(state.iterations());
  state.counters["vertices"] = static_cast<double>(vertices);
  state.counters[kPerVertex] =
      benchmark::Counter(billions, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void sweep(benchmark::State& state, const Polygons& polygons) {
  Boundary boundary;
  Trapezoidation trapezoidation;
  TrapezoidalGraph graph;
  for (auto _ : state) {
    for (const Rings& rings : polygons) {
      boundary.assign(rings);
      if (!trapezoidation.build(boundary, graph))
        return state.SkipWithError("a polygon crosses itself");
    }
  }
  count_vertices(state, vertices_of(polygons));
}

void build(benchmark::State& state, Polygons& polygons) {
  GraphBuilder builder;
  TrapezoidalGraph graph;
  for (auto _ : state) {
    for (Rings& rings : polygons) benchmark::DoNotOptimize(builder.build(rings, graph));
  }
  count_vertices(state, vertices_of(polygons));
}

void weigh(benchmark::State& state, const Polygons& polygons) {
  VertexWeights weights;
  for (auto _ : state) {
    for (const Rings& rings : polygons) {
      for (std::size_t i = 0; i < rings.size(); ++i) {
        benchmark::DoNotOptimize(weights.weigh(rings[i], WeightRule::douglas_peucker));
      }
    }
  }
  count_vertices(state, vertices_of(polygons));
}

void record_history(benchmark::State& state, Polygons& polygons) {
  GraphBuilder builder;
  TrapezoidalGraph graph;
  HistoryRecorder recorder;
  History history;
  for (auto _ : state) {
    history.vertices.clear();
    history.edges.clear();
    history.trapezoids.clear();
    history.lifespans.clear();
    history.grains.clear();
    for (Rings& rings : polygons) {
      if (builder.build(rings, graph).built) recorder.record(graph, {}, history);
    }
  }
  const std::size_t vertices = vertices_of(polygons);
  count_vertices(state, vertices);
  state.counters["versions_per_vertex"] =
      static_cast<double>(history.trapezoids.size()) / static_cast<double>(vertices);
}

void record_on_cores(benchmark::State& state, Polygons& polygons, unsigned threads) {
  GraphBuilder builder;
  TrapezoidalGraph graph;
  HistoryRecorder recorder;
  PriorityStack::Counts counts;
  for (auto _ : state) {
    counts = {};
    for (Rings& rings : polygons) {
      if (!builder.build(rings, graph, threads).built) continue;
      History history;
      recorder.record(graph, FaceFeatures({0}), {}, history, nullptr, threads);
      const PriorityStack::Counts& of_one = recorder.stack().counts();
      counts.removals += of_one.removals;
      counts.at_once += of_one.at_once;
      counts.walked += of_one.walked + of_one.touched;
      counts.beside += of_one.beside;
    }
  }
  count_vertices(state, vertices_of(polygons));
  state.counters["at_once"] =
      static_cast<double>(counts.at_once) / static_cast<double>(counts.removals);
  state.counters["removals_times_as_fast"] =
      static_cast<double>(counts.walked) / static_cast<double>(counts.walked - counts.beside);
}

/// The polygons used last: repetitions are consecutive.
Polygons& remembered(const std::string& name, const std::function<Polygons()>& make) {
  static std::string last;
  static Polygons polygons;
  if (last != name) {
    polygons.clear();
    polygons = make();
    last = name;
  }
  return polygons;
}

double smallest(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}

benchmark::internal::Benchmark* add(const std::string& stage,
                                    const std::function<void(benchmark::State&, Polygons&)>& run,
                                    const std::string& name,
                                    const std::function<Polygons()>& make) {
  return benchmark::RegisterBenchmark(
             (stage + "/" + name).c_str(),
             [=](benchmark::State& state) { run(state, remembered(name, make)); })
      ->Unit(benchmark::kMillisecond)
      ->MinTime(0.1)
      ->Repetitions(3)
      ->ComputeStatistics("min", smallest)
      ->DisplayAggregatesOnly();
}

void add_stages(const std::string& name, const std::function<Polygons()>& make) {
  add(
      "Sweep", [](benchmark::State& s, Polygons& p) { sweep(s, p); }, name, make);
  add("Build", build, name, make);
  add(
      "Weights", [](benchmark::State& s, Polygons& p) { weigh(s, p); }, name, make);
  add("History", record_history, name, make);
}

void add_cores(const std::string& name, const std::function<Polygons()>& make) {
  for (const unsigned threads : {1u, 2u, 4u, 8u, 16u}) {
    add(
        "Cores" + std::to_string(threads),
        [threads](benchmark::State& s, Polygons& p) { record_on_cores(s, p, threads); }, name,
        make);
  }
}

Polygons buildings() {
  Polygons polygons;
  for (std::uint32_t seed = 0; seed < 5000; ++seed) polygons.push_back(building(seed));
  return polygons;
}

void add_families() {
  for (const PolygonFamily& family : kPolygonFamilies) {
    for (std::size_t n = 1000; n <= 1000000; n *= 10) {
      const std::string name = std::string(family.name) + "/" + std::to_string(n);
      add_stages(name, [&family, n] { return Polygons{family.make(n)}; });
    }
  }
}

void add_files() {
  const char* folder = std::getenv("TRAPEZE_DATA");
  if (folder == nullptr) {
    std::fprintf(stderr, "TRAPEZE_DATA is not set: no real polygons are measured\n");
    return;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".fgb") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    const std::string path = file.string();
    const std::string name = file.stem().string();
    const auto make = [path] { return read_source_rings(path); };
    add("Build", build, name, make);
    add("History", record_history, name, make);
    if (std::ranges::any_of(
            make(), [](const Rings& rings) { return rings.points.size() >= kLargePolygon; })) {
      add_cores(name, make);
    }
  }
}

/// The usual table, followed by how the time per vertex grows in each family.
class GrowthReporter : public benchmark::ConsoleReporter {
 public:
  GrowthReporter() : ConsoleReporter(OO_Tabular) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.error_occurred || run.aggregate_name != "min") continue;
      const std::string name = run.run_name.function_name;
      const std::size_t slash = name.rfind('/');
      if (slash == name.find('/')) continue;  // without a size, it is not a family
      const double n = std::stod(name.substr(slash + 1));
      figures_[name.substr(0, slash)][n] = run.counters.at(kPerVertex).value;
    }
  }

  void Finalize() override {
    ConsoleReporter::Finalize();
    // From 10^3 to 10^6 vertices log n doubles, and each step through a tree of all edges costs up
    // to ten times more once the tree has outgrown the cache. A cost that grows with n grows by 500
    // beyond log n; one that grows with the root of n, by 16.
    constexpr double kAllowed = 12;
    std::printf(
        "\nns per vertex at the smallest and the largest size; \"growth\" is beyond log n\n");
    for (const auto& [name, by_size] : figures_) {
      if (by_size.size() < 2) continue;
      const auto [small, at_small] = *by_size.begin();
      const auto [large, at_large] = *by_size.rbegin();
      const double growth = at_large / at_small / (std::log(large) / std::log(small));
      std::printf("%-24s %9.0f %9.0f   growth %6.1f%s\n", name.c_str(), at_small, at_large, growth,
                  growth > kAllowed ? "   TOO FAST" : "");
    }
  }

 private:
  std::map<std::string, std::map<double, double>> figures_;
};

}  // namespace
}  // namespace trapeze

int main(int argc, char** argv) {
  trapeze::add_stages("buildings", trapeze::buildings);
  trapeze::add_families();
  trapeze::add_files();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  trapeze::GrowthReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
