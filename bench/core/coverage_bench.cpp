// The cost of shared borders: layers with coverage off and auto, in turns.
//
//   TRAPEZE_DATA=folder coverage_bench
//
// Measures building from the file to the layer, on one core and on all; the memory of graphs and of
// layers; tiles at zooms 0 to 14 that contain random vertices, selected and drawn; and the vertices
// that remain at each zoom, compared with those that mapshaper leaves at the same tolerance. Also
// measures building blocks: a town with merge 4, compared with the same without. Of repeated
// measurements, the shortest counts, and for tiles the processor time: these are least affected by
// other load on the machine.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "bench/core/coverage_vertices.h"
#include "bench/core/source_rings.h"
#include "bench/measure/figures.h"
#include "bench/measure/run_program.h"
#include "bench/measure/trip.h"
#include "bench/server/trapeze_server.h"
#include "core/borders/coverage_groups.h"
#include "core/grid/tolerance.h"
#include "core/io/load/load_layer.h"
#include "core/sweep/clean_rings.h"
#include "core/sweep/graph_builder.h"
#include "render/make_renderer.h"

namespace trapeze {
namespace {

constexpr int kLastZoom = 14;
constexpr double kTolerance = 0.25;  // pixels, the default of requests
constexpr double kNoGaps = 0;        // gaps are not closed
constexpr std::array kModes = {CoverageMode::off, CoverageMode::automatic};
constexpr std::array kMerge = {0.0, 4.0};  // pixels: without and with blocks

struct Options {
  std::vector<std::string> layers{"europe_countries", "us_counties", "countries"};
  std::vector<std::string> towns{"shenzhen_buildings"};
  std::string sample = TRAPEZE_BENCH_FOLDER "/../data";
  std::string program = built_trapeze();
  std::size_t tiles = 16;
  int rounds = 3;
  bool only_build = false;
  std::string json = "out/bench/coverage.json";
};

struct Seconds {
  double cpu = HUGE_VAL;
  double wall = HUGE_VAL;

  void take_shorter(const Seconds& other) {
    cpu = std::min(cpu, other.cpu);
    wall = std::min(wall, other.wall);
  }
};

template <typename Work>
Seconds timed(const Work& work) {
  const auto cpu_seconds = [] {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  const auto begin = std::chrono::steady_clock::now();
  const double cpu_begin = cpu_seconds();
  work();
  return {cpu_seconds() - cpu_begin,
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()};
}

std::string path_of(const Options& options, const std::string& layer) {
  return (layer == "countries" ? options.sample : real_data_folder()) + "/" + layer + ".fgb";
}

Level level_of_zoom(int zoom) {
  return nearest_level(kTolerance * static_cast<double>(TileId{zoom, 0, 0}.side()) / kTilePixels);
}

/// A layer in both modes, in the order of kModes.
struct Pair {
  std::array<std::unique_ptr<Layer>, kModes.size()> layers;
  std::array<Seconds, kModes.size()> one_core;
  std::array<Seconds, kModes.size()> all_cores;
};

std::unique_ptr<Layer> load(const std::string& path, const LayerOptions& generalization,
                            unsigned threads) {
  LoadOptions options;
  options.threads = threads;
  options.generalization = generalization;
  return load_layer(path, options).layer;
}

LayerOptions options_of(CoverageMode mode, WeightRule rule = WeightRule::douglas_peucker) {
  LayerOptions options;
  options.weights = rule;
  options.coverage = mode;
  return options;
}

Pair build(const std::string& path, int rounds) {
  Pair pair;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t mode = 0; mode < kModes.size(); ++mode) {
      std::unique_ptr<Layer>& layer = pair.layers[mode];
      const LayerOptions options = options_of(kModes[mode]);
      pair.one_core[mode].take_shorter(timed([&] { layer = load(path, options, 1); }));
      pair.all_cores[mode].take_shorter(timed([&] { layer = load(path, options, 0); }));
    }
  }
  return pair;
}

/// Bytes of the graphs that the history is recorded from, if all existed at the same time.
std::size_t memory_of_graphs(std::vector<Rings> features, CoverageMode mode) {
  std::size_t bytes = 0;
  std::vector<bool> is_done(features.size());
  if (mode != CoverageMode::off) {
    std::vector<const Rings*> all;
    for (Rings& rings : features) {
      clean_rings(rings);
      all.push_back(&rings);
    }
    CoverageBuilder builder;
    for (const auto& group : group_features(all, mode)) {
      std::vector<const Rings*> of_group;
      of_group.reserve(group.size());
      for (const std::uint32_t i : group) of_group.push_back(all[i]);
      TrapezoidalGraph graph;
      const Assembly assembly = assemble(of_group, mode, kNoGaps, builder, graph);
      if (assembly.together.empty()) continue;
      bytes += graph.memory();
      for (const std::uint32_t i : assembly.together) is_done[group[i]] = true;
    }
  }
  GraphBuilder builder;
  for (std::size_t i = 0; i < features.size(); ++i) {
    TrapezoidalGraph graph;
    if (!is_done[i] && builder.build(features[i], graph).built) bytes += graph.memory();
  }
  return bytes;
}

/// Milliseconds of processor time per tile, selected and drawn, by mode.
std::array<double, kModes.size()> draw(const Pair& pair, const std::vector<TileId>& tiles,
                                       int rounds, MaskRenderer& renderer) {
  std::array<double, kModes.size()> sums{};
  std::vector<TrapezoidRange> ranges;
  Mask mask;
  for (const TileId& tile : tiles) {
    const View view = View::of_tile(tile);
    const Level level = level_of_zoom(tile.z);
    std::array<Seconds, kModes.size()> shortest;
    for (int round = 0; round <= rounds; ++round) {
      for (std::size_t mode = 0; mode < kModes.size(); ++mode) {
        const Layer& layer = *pair.layers[mode];
        const Seconds seconds = timed([&] {
          layer.select({view.box(), level, level, SmallPolygons::dust}, ranges);
          layer.keep_uppermost(ranges);
          renderer.draw(layer.mesh(), ranges, view, mask);
        });
        if (round > 0) shortest[mode].take_shorter(seconds);  // the first one uploads
      }
    }
    for (std::size_t mode = 0; mode < kModes.size(); ++mode) {
      sums[mode] += 1e3 * shortest[mode].cpu;
    }
  }
  for (double& sum : sums) sum /= static_cast<double>(std::max<std::size_t>(tiles.size(), 1));
  return sums;
}

void set_times(const Seconds& one_core, const Seconds& all_cores, Figure& figure) {
  figure.set("built on one core, cpu s", one_core.cpu);
  figure.set("built on one core, wall s", one_core.wall);
  figure.set("built on all cores, cpu s", all_cores.cpu);
  figure.set("built on all cores, wall s", all_cores.wall);
}

void report_build(const std::string& layer, const std::string& path, const Pair& pair,
                  std::vector<Figure>& figures) {
  const std::vector<Rings> rings = read_source_rings(path);
  for (std::size_t mode = 0; mode < kModes.size(); ++mode) {
    Figure figure("coverage/" + layer + "/" + std::string(kCoverageNames.name_of(kModes[mode])));
    set_times(pair.one_core[mode], pair.all_cores[mode], figure);
    figure.set("graphs, MB", static_cast<double>(memory_of_graphs(rings, kModes[mode])) / 1e6);
    figure.set("layer with history, MB", static_cast<double>(pair.layers[mode]->memory()) / 1e6);
    print_line(figure);
    figures.push_back(std::move(figure));
  }
}

void report_tiles(const Options& options, const std::string& layer, const std::string& path,
                  const Pair& pair, std::vector<Figure>& figures) {
  const std::vector<TripLayer> source{{layer, path, ""}};
  const Places places = read_places(source);
  for (const RendererKind kind : {RendererKind::software, RendererKind::egl}) {
    std::unique_ptr<MaskRenderer> renderer;
    try {
      renderer = make_renderer({kind, {}}).renderer;
    } catch (const std::exception& error) {
      std::printf("coverage/%s: %s\n", layer.c_str(), error.what());
      continue;
    }
    const std::string name = "coverage/" + layer + "/" + std::string(renderer->name());
    std::printf("%s: cpu ms a tile; zoom, off, auto, auto / off\n", name.c_str());
    for (int zoom = 0; zoom <= kLastZoom; ++zoom) {
      const auto tiles = tiles_at_vertices(places, zoom, zoom, options.tiles);
      const auto [off, automatic] = draw(pair, tiles, options.rounds, *renderer);
      Figure figure(name + "/zoom " + std::to_string(zoom));
      figure.set("off, cpu ms", off);
      figure.set("auto, cpu ms", automatic);
      figures.push_back(std::move(figure));
      std::printf("%5d %9.4f %9.4f %6.2f\n", zoom, off, automatic, automatic / off);
    }
    std::fflush(stdout);
  }
}

/// For the layer with coverage, with the same rule as mapshaper, if that is installed; and for the
/// layer without coverage.
void report_vertices(const std::string& name, const Layer& layer, const Layer& apart,
                     WeightRule rule, const Mapshaper* mapshaper, std::vector<Figure>& figures) {
  std::vector<double> tolerances;
  for (int zoom = 0; zoom <= kLastZoom; ++zoom) {
    tolerances.push_back(epsilon_of_level(level_of_zoom(zoom)));
  }
  std::vector<std::size_t> theirs;
  if (mapshaper != nullptr) theirs = mapshaper->vertices_left(rule, tolerances);
  std::printf("%s: vertices; zoom, off, auto, of these junctions, mapshaper, auto / mapshaper\n",
              name.c_str());
  for (int zoom = 0; zoom <= kLastZoom; ++zoom) {
    const Level level = level_of_zoom(zoom);
    const VerticesLeft left = vertices_left(layer, level);
    const std::size_t left_apart = vertices_left(apart, level).stored;
    Figure figure(name + "/zoom " + std::to_string(zoom));
    figure.set("vertices, off", static_cast<double>(left_apart));
    figure.set("vertices", static_cast<double>(left.positions));
    figure.set("junctions", static_cast<double>(left.junctions));
    std::printf("%5d %9zu %9zu %9zu", zoom, left_apart, left.positions, left.junctions);
    if (!theirs.empty()) {
      const auto count = static_cast<double>(theirs[static_cast<std::size_t>(zoom)]);
      figure.set("vertices of mapshaper", count);
      std::printf(" %9.0f %6.3f", count, static_cast<double>(left.positions) / count);
    }
    std::printf("\n");
    figures.push_back(std::move(figure));
  }
  std::fflush(stdout);
}

void measure(const Options& options, const std::string& layer, std::vector<Figure>& figures) {
  const std::string path = path_of(options, layer);
  const Pair pair = build(path, options.rounds);
  report_build(layer, path, pair, figures);
  if (options.only_build) return;
  report_tiles(options, layer, path, pair, figures);
  std::unique_ptr<Mapshaper> mapshaper;
  if (Mapshaper::is_installed()) mapshaper = std::make_unique<Mapshaper>(options.program, path);
  for (const WeightRule rule : {WeightRule::douglas_peucker, WeightRule::effective_area}) {
    report_vertices("coverage/" + layer + "/" + std::string(kWeightNames.name_of(rule)),
                    *load(path, options_of(CoverageMode::automatic, rule), 0),
                    *load(path, options_of(CoverageMode::off, rule), 0), rule, mapshaper.get(),
                    figures);
  }
}

void measure_blocks(const Options& options, const std::string& town, std::vector<Figure>& figures) {
  const std::string path = path_of(options, town);
  std::array<Seconds, kMerge.size()> one_core;
  std::array<Seconds, kMerge.size()> all_cores;
  std::array<double, kMerge.size()> bytes{};
  for (int round = 0; round < options.rounds; ++round) {
    for (std::size_t i = 0; i < kMerge.size(); ++i) {
      LayerOptions generalization;
      generalization.merge = kMerge[i];
      std::unique_ptr<Layer> layer;
      one_core[i].take_shorter(timed([&] { layer = load(path, generalization, 1); }));
      all_cores[i].take_shorter(timed([&] { layer = load(path, generalization, 0); }));
      bytes[i] = static_cast<double>(layer->memory());
    }
  }
  for (std::size_t i = 0; i < kMerge.size(); ++i) {
    Figure figure("blocks/" + town + (kMerge[i] == 0 ? "/plain" : "/merge"));
    set_times(one_core[i], all_cores[i], figure);
    figure.set("layer with history, MB", bytes[i] / 1e6);
    print_line(figure);
    figures.push_back(std::move(figure));
  }
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("What it takes that neighbours share their borders (TRAPEZE_DATA)");
  app.add_option("--layer", options.layers, "Files without .fgb; countries is that of the sample")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--town", options.towns, "Likewise, of which blocks are built")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--sample", options.sample, "The folder of the sample")->capture_default_str();
  app.add_option("--server", options.program, "The program trapeze")->capture_default_str();
  app.add_option("--tiles", options.tiles, "Tiles of every layer and zoom")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--rounds", options.rounds, "How often each is built and drawn")
      ->check(CLI::Range(1, 99))
      ->capture_default_str();
  app.add_flag("--only-build", options.only_build, "Leave out tiles and vertices");
  app.add_option("--json", options.json, "Where the figures go")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (!options.only_build && !Mapshaper::is_installed()) {
    std::printf("mapshaper is not installed; script/bootstrap peers does that\n");
  }
  std::vector<Figure> figures;
  for (const std::string& layer : options.layers) measure(options, layer, figures);
  for (const std::string& town : options.towns) measure_blocks(options, town, figures);
  write_figures(figures, command_line(argc, argv), options.json);
  return 0;
}

}  // namespace
}  // namespace trapeze

int main(int argc, char** argv) {
  return trapeze::run_program("coverage_bench", trapeze::run, argc, argv);
}
