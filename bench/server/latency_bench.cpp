// The time for one tile of any layer at any zoom, when nothing else is requested.
//
//   TRAPEZE_DATA=folder latency_bench
//
// Every FlatGeobuf file of the folder is a layer. At every zoom from 0 to 22, tiles that contain
// random vertices are requested, uncached, one after another over one connection. The median time
// of each tile counts, which excludes the effects of other load on the machine.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/measure/figures.h"
#include "bench/measure/http_load.h"
#include "bench/measure/run_program.h"
#include "bench/measure/trip.h"
#include "bench/server/trapeze_server.h"

namespace trapeze {
namespace {

constexpr int kLastZoom = 22;

struct Options {
  std::vector<std::string> renderers{"egl", "software"};
  std::string program = built_trapeze();
  std::vector<std::string> layers;  // empty: all
  std::size_t tiles = 30;
  int rounds = 3;
  std::string json = "out/bench/latency.json";
};

std::vector<TripLayer> layers_of(const std::string& folder,
                                 const std::vector<std::string>& chosen) {
  std::vector<TripLayer> layers;
  const auto is_chosen = [&](const std::string& name) {
    return chosen.empty() || std::ranges::find(chosen, name) != chosen.end();
  };
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".fgb" || !is_chosen(entry.path().stem().string())) continue;
    layers.push_back({entry.path().stem().string(), entry.path().string(), "a05040"});
  }
  if (layers.empty()) throw std::runtime_error("there is no such FlatGeobuf file in " + folder);
  std::ranges::sort(layers, {}, &TripLayer::name);
  return layers;
}

/// The median time of each tile, from `rounds` rounds over all tiles.
std::vector<TileTime> middle_times(const std::vector<TileTime>& times, std::size_t rounds) {
  const std::size_t count = times.size() / rounds;
  std::vector<TileTime> middle;
  for (std::size_t tile = 0; tile < count; ++tile) {
    std::vector<double> of_tile;
    for (std::size_t round = 0; round < rounds; ++round) {
      of_tile.push_back(times[round * count + tile].ms);
    }
    middle.push_back({times[tile].zoom, percentiles_of(std::move(of_tile)).p50});
  }
  return middle;
}

TileRun measure_layer(const TrapezeServer& server, const Trip& trip, int rounds, Figure& figure) {
  // With one connection, responses arrive in the order of the requests.
  TileRun run = uncached_run(server, trip, {.connections = 1}, rounds);
  figure.set("longest answer, ms", std::ranges::max(run.tiles, {}, &TileTime::ms).ms);
  run.tiles = middle_times(run.tiles, static_cast<std::size_t>(rounds));
  run.seconds /= rounds;
  run.cpu_seconds /= rounds;
  figure.add(run);
  return run;
}

/// The layer and zoom with the slowest tiles.
Figure slowest(const std::vector<Figure>& figures, const std::string& renderer) {
  Figure worst("latency/trapeze-" + renderer + "/slowest");
  double p99 = 0;
  for (const Figure& figure : figures) {
    for (const auto& [zoom, percentiles] : figure.percentiles_by_zoom()) {
      if (percentiles.p99 <= p99) continue;
      p99 = percentiles.p99;
      worst.note(figure.name() + " at zoom " + std::to_string(zoom));
    }
  }
  worst.set("p99_ms", p99);
  return worst;
}

std::vector<Figure> measure_renderer(const Options& options, const std::string& renderer,
                                     const std::vector<TripLayer>& layers) {
  const TrapezeServer server(layers, {options.program, renderer});
  std::vector<Figure> figures;
  Figure all("latency/trapeze-" + renderer + "/all");
  for (const TripLayer& layer : layers) {
    const std::vector<TripLayer> alone{layer};
    const Trip trip{layer.name, alone,
                    tiles_at_vertices(read_places(alone), 0, kLastZoom, options.tiles)};
    figures.emplace_back("latency/trapeze-" + renderer + "/" + layer.name);
    all.add(measure_layer(server, trip, options.rounds, figures.back()));
    print_line(figures.back());
    print_zooms(figures.back());
  }
  const Figure worst = slowest(figures, renderer);
  print_line(all);
  print_line(worst);
  figures.push_back(all);
  figures.push_back(worst);
  return figures;
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("How long one tile takes, of any layer of TRAPEZE_DATA at any zoom");
  app.add_option("--renderer", options.renderers)->delimiter(',')->capture_default_str();
  app.add_option("--layer", options.layers, "Only these: file names without .fgb")->delimiter(',');
  app.add_option("--server", options.program, "The program trapeze")->capture_default_str();
  app.add_option("--tiles", options.tiles, "Tiles of every layer and zoom")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--rounds", options.rounds, "How often each is asked for")
      ->check(CLI::Range(1, 99))
      ->capture_default_str();
  app.add_option("--json", options.json, "Where the figures go")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const auto layers = layers_of(real_data_folder(), options.layers);
  std::vector<Figure> figures;
  print_table_head();
  for (const std::string& renderer : options.renderers) {
    const auto more = measure_renderer(options, renderer, layers);
    figures.insert(figures.end(), more.begin(), more.end());
  }
  write_figures(figures, command_line(argc, argv), options.json);
  return 0;
}

}  // namespace
}  // namespace trapeze

int main(int argc, char** argv) {
  return trapeze::run_program("latency_bench", trapeze::run, argc, argv);
}
