// Trapeze compared with Mapnik and MapServer: the same tiles of the same polygons in the same
// colours, in one run, nothing cached, with all cores for the program being measured.
//
//   TRAPEZE_DATA=folder peers_bench                  all trips
//   peers_bench --trip malta --rounds 1              one of them, once
//   peers_bench --layers --no-simplify --rounds 1    every layer of the folder by itself
//   peers_bench --pictures out/bench/pictures        pictures of all three side by side, no times
//
// Mapnik draws within its process (mapnik_trip), without HTTP; Trapeze and MapServer are measured
// over HTTP with the same client. "-simplify" uses the simplification that Mapnik and MapServer
// offer. Programs that are not installed are left out, with a message.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/measure/child_process.h"
#include "bench/measure/figures.h"
#include "bench/measure/http_load.h"
#include "bench/measure/run_program.h"
#include "bench/measure/trip.h"
#include "bench/peers/map_server.h"
#include "bench/peers/peer_maps.h"
#include "bench/peers/side_by_side.h"
#include "bench/server/trapeze_server.h"

namespace trapeze {
namespace {

struct Options {
  std::vector<std::string> trips = trip_names();
  std::string program = built_trapeze();
  int rounds = 3;
  bool has_simplified = true;  // also the peers with simplification
  int connections = 16;
  std::string pictures;
  std::string json = "out/bench/peers.json";
};

/// A program that draws a trip, and its result.
struct Contestant {
  std::function<TileRun(const Trip&)> draw;
  Figure figure;
  bool is_slow = false;  // its figure covers some of the tiles, or none
};

std::string mapnik_program() {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "mapnik_trip").string();
}

bool has_mapnik() {
  if (std::filesystem::exists(mapnik_program())) return true;
  std::fprintf(stderr, "peers_bench: without Mapnik: libmapnik-dev was not there when building\n");
  return false;
}

bool has_mapserver() {
  if (has_program("mapserv") && has_program("lighttpd")) return true;
  std::fprintf(stderr, "peers_bench: without MapServer: mapserv or lighttpd is not installed\n");
  return false;
}

TileRun read_mapnik_result(const std::string& path) {
  std::ifstream file(path);
  TileRun run;
  file >> run.seconds >> run.cpu_seconds;
  for (TileTime tile; file >> tile.zoom >> tile.ms >> tile.bytes;) run.tiles.push_back(tile);
  if (run.tiles.empty()) throw std::runtime_error("Mapnik left no result in " + path);
  return run;
}

/// Draws a trip in all available ways, from one set of files.
class Contest {
 public:
  Contest(Trip trip, const Options& options) : trip_(std::move(trip)), options_(options) {
    write_shapes(trip_, folder_.path());
    for (const char* renderer : {"egl", "software"}) add_trapeze(renderer);
    for (const Simplify simplify : {Simplify::off, Simplify::on}) {
      if (simplify == Simplify::on && !options_.has_simplified) continue;
      if (has_mapnik()) add_mapnik(simplify);
      if (has_mapserver()) add_mapserver(simplify);
    }
  }
  Contest(const Contest&) = delete;
  Contest& operator=(const Contest&) = delete;

  void run() {
    for (std::size_t peer = kOurs; peer < contestants_.size(); ++peer) try_out(contestants_[peer]);
    for (int round = 0; round < options_.rounds; ++round) {
      for (Contestant& contestant : contestants_) {
        if (!contestant.is_slow) contestant.figure.add(contestant.draw(trip_));
      }
    }
  }

  /// Appends a figure for each contestant, and how many times as fast as each peer Trapeze is: by
  /// tiles per second, and by processor time per tile, which is less affected by other load on the
  /// machine.
  void append_to(std::vector<Figure>& figures) const {
    for (const Contestant& contestant : contestants_) figures.push_back(contestant.figure);
    for (std::size_t ours = 0; ours < kOurs; ++ours) figures.push_back(ratios_of(ours));
  }

  /// Draws a few tiles of the trip with all three.
  void draw_side_by_side() const {
    const Trip some{trip_.name, trip_.layers, some_tiles()};
    SideBySide pictures;
    pictures.add("trapeze", trapeze_pictures(some));
    if (has_mapnik()) pictures.add("mapnik", mapnik_pictures(some));
    if (has_mapserver()) pictures.add("mapserver", mapserver_pictures(some));
    pictures.print_differences();
    std::filesystem::create_directories(options_.pictures);
    pictures.write(options_.pictures + "/" + trip_.name + ".png");
  }

 private:
  static constexpr std::size_t kOurs = 2;
  static constexpr std::size_t kOneOf = 12;
  static constexpr int kHopelessSeconds = 5;  // of wall time, for a tile
  static constexpr int kSlowSeconds = 90;     // for a trip

  /// One tile out of so many, so that all zooms are represented.
  Trip some_of_trip(std::size_t one_of) const {
    Trip some{trip_.name, trip_.layers, {}};
    for (std::size_t i = 0; i < trip_.tiles.size(); i += one_of) {
      some.tiles.push_back(trip_.tiles[i]);
    }
    return some;
  }

  /// Why the contestant cannot take part; empty if it can.
  std::string failure_of(const Contestant& contestant) const {
    try {
      const double seconds = contestant.draw(some_of_trip(trip_.tiles.size())).seconds;
      if (seconds < kHopelessSeconds) return {};
      return "the first tile took " + std::to_string(static_cast<int>(seconds)) + " seconds";
    } catch (const std::exception& error) {
      return error.what();
    }
  }

  /// A contestant that fails at the first tile has no figure; one that would need minutes for all
  /// tiles gets a figure for some of them.
  void try_out(Contestant& contestant) const {
    if (const std::string failure = failure_of(contestant); !failure.empty()) {
      contestant.is_slow = true;
      contestant.figure.note("takes no part: " + failure);
      return;
    }
    TileRun run = contestant.draw(some_of_trip(kOneOf));
    contestant.is_slow = run.seconds * kOneOf > kSlowSeconds;
    if (!contestant.is_slow) return;
    contestant.figure.note("one of " + std::to_string(kOneOf) + " tiles");
    contestant.figure.add(std::move(run));
  }

  void add(const std::string& name, std::function<TileRun(const Trip&)> draw) {
    contestants_.push_back({std::move(draw), Figure(trip_.name + "/" + name)});
  }

  Figure ratios_of(std::size_t ours) const {
    const Figure& us = contestants_[ours].figure;
    Figure ratios(us.name() + "/times as fast");
    for (std::size_t peer = kOurs; peer < contestants_.size(); ++peer) {
      const Figure& them = contestants_[peer].figure;
      if (!them.has_runs()) continue;
      const std::string name = "as " + them.name().substr(trip_.name.size() + 1);
      ratios.set(name, us.tiles_per_second() / them.tiles_per_second());
      ratios.set(name + ", by processor time", them.cpu_ms_per_tile() / us.cpu_ms_per_tile());
      ratios.set(name + ", times the bytes", us.bytes_per_tile() / them.bytes_per_tile());
    }
    return ratios;
  }

  static std::string named(const std::string& name, Simplify simplify) {
    return simplify == Simplify::on ? name + "-simplify" : name;
  }

  void add_trapeze(const std::string& renderer) {
    add("trapeze-" + renderer, [this, renderer](const Trip& trip) {
      const TrapezeServer server(trip.layers, {options_.program, renderer});
      return uncached_run(server, trip, {.connections = options_.connections});
    });
  }

  void add_mapnik(Simplify simplify) {
    const std::string map = write_mapnik_map(trip_, folder_.path(), simplify);
    add(named("mapnik", simplify),
        [this, map](const Trip& trip) { return run_mapnik(trip, map, {}); });
  }

  void add_mapserver(Simplify simplify) {
    const std::string map = write_mapserver_map(trip_, folder_.path(), simplify);
    add(named("mapserver", simplify), [this, map](const Trip& trip) {
      const MapServer server(map);
      const double before = server.cpu_seconds();
      const LoadResult result =
          load_http(server.port(), server.requests(trip), {.connections = options_.connections});
      TileRun run = tile_run(trip, result, true);
      run.cpu_seconds = server.cpu_seconds() - before;
      return run;
    });
  }

  TileRun run_mapnik(const Trip& trip, const std::string& map, const std::string& pictures) const {
    const std::string result = folder_.path() + "/mapnik.result";
    std::vector<std::string> arguments{mapnik_program(), map, write_tiles(trip, folder_.path()),
                                       result};
    if (!pictures.empty()) arguments.insert(arguments.end(), {"1", "png8", pictures});
    run_to_end(arguments, folder_.path() + "/mapnik.log");
    return read_mapnik_result(result);
  }

  std::vector<TileId> some_tiles() const {
    constexpr std::size_t kCount = 8;
    const TrapezeServer server(trip_.layers, {options_.program, "software"});
    const LoadResult result = load_http(server.port(), tile_requests(trip_), {});
    std::vector<Exchange> exchanges = result.exchanges;
    std::erase_if(exchanges, [](const Exchange& exchange) { return exchange.bytes < 600; });
    std::ranges::sort(exchanges, {}, &Exchange::request);
    std::vector<TileId> tiles;
    for (std::size_t i = 0; i < std::min(kCount, exchanges.size()); ++i) {
      tiles.push_back(
          trip_
              .tiles[exchanges[i * exchanges.size() / std::min(kCount, exchanges.size())].request]);
    }
    return tiles;
  }

  std::vector<std::string> trapeze_pictures(const Trip& trip) const {
    const TrapezeServer server(trip.layers, {options_.program, "software"});
    return load_http(server.port(), tile_requests(trip), {.keep_bodies = true}).bodies;
  }

  std::vector<std::string> mapserver_pictures(const Trip& trip) const {
    const MapServer server(write_mapserver_map(trip, folder_.path(), Simplify::off));
    return load_http(server.port(), server.requests(trip), {.keep_bodies = true}).bodies;
  }

  std::vector<std::string> mapnik_pictures(const Trip& trip) const {
    const ScratchFolder pictures;
    run_mapnik(trip, write_mapnik_map(trip, folder_.path(), Simplify::off), pictures.path());
    std::vector<std::string> bytes;
    for (const TileId& tile : trip.tiles) {
      std::ifstream file(pictures.path() + "/" + std::to_string(tile.z) + "_" +
                             std::to_string(tile.x) + "_" + std::to_string(tile.y) + ".png",
                         std::ios::binary);
      bytes.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
    return bytes;
  }

  const Trip trip_;
  const Options& options_;
  const ScratchFolder folder_;
  std::vector<Contestant> contestants_;
};

void measure_all(const Options& options, const std::string& command) {
  std::vector<Figure> figures;
  print_table_head();
  for (const std::string& name : options.trips) {
    Contest contest(named_trip(name, real_data_folder()), options);
    contest.run();
    const std::size_t first = figures.size();
    contest.append_to(figures);
    for (std::size_t i = first; i < figures.size(); ++i) print_line(figures[i]);
  }
  write_figures(figures, command, options.json);
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("Trapeze beside Mapnik and MapServer, on trips over real maps (TRAPEZE_DATA)");
  app.add_option("--trip", options.trips, "Which ones, or names of layers")
      ->delimiter(',')
      ->capture_default_str();
  bool by_layer = false;
  app.add_flag("--layers", by_layer, "Every layer by itself");
  app.add_flag("!--no-simplify", options.has_simplified,
               "Without Mapnik and MapServer simplifying");
  app.add_option("--server", options.program, "The program trapeze")->capture_default_str();
  app.add_option("--rounds", options.rounds, "How often all is measured")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--connections", options.connections)
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--pictures", options.pictures,
                 "Measure nothing; write tiles of all three side by side into this folder");
  app.add_option("--json", options.json, "Where the figures go")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  if (by_layer) options.trips = layer_names(real_data_folder());
  if (options.pictures.empty()) {
    measure_all(options, command_line(argc, argv));
    return 0;
  }
  for (const std::string& name : options.trips) {
    Contest(named_trip(name, real_data_folder()), options).draw_side_by_side();
  }
  return 0;
}

}  // namespace
}  // namespace trapeze

int main(int argc, char** argv) {
  return trapeze::run_program("peers_bench", trapeze::run, argc, argv);
}
