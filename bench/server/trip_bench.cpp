// Trapeze over HTTP: trips over real maps, first uncached, then repeated.
//
//   TRAPEZE_DATA=folder trip_bench                          all trips, EGL and software
//   trip_bench --trip malta --renderer egl --rounds 1       one of them, once
//   trip_bench --trip malta --port 8080 --repeat 20         a running server, for a profile
//
// For every trip and renderer:
//   cold    all tiles once over 16 connections, from a server that was just started
//   alone   the same over one connection: the time for a tile when nothing else is requested
//   warm    all tiles again, now that they are known
//   cached  one tile after another for some seconds, all known
//   304     the same, requested with the entity tags that were sent with them
//   first   all tiles once, with these entity tags, from a server that was just started and has
//   drawn
//           nothing: the time to find out that they are unchanged
// The servers for cold and alone cache no tiles, because many are equal. Repeated tiles, because
// views overlap or because a trip with few tiles is repeated, are requested in a slightly different
// colour, so that no tile drawn earlier can be used. Servers are restarted for every round.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "bench/measure/figures.h"
#include "bench/measure/http_load.h"
#include "bench/measure/run_program.h"
#include "bench/measure/trip.h"
#include "bench/server/trapeze_server.h"

namespace trapeze {
namespace {

struct Options {
  std::vector<std::string> trips = trip_names();
  std::vector<std::string> renderers{"egl", "software"};
  std::string program = built_trapeze();
  std::vector<std::string> more;
  int rounds = 3;
  int repeat = 0;
  int connections = 16;
  int pipeline = 1;
  double seconds = 3;
  std::uint16_t port = 0;
  std::string json = "out/bench/trip.json";
};

struct Rate {
  double per_second = 0;
  double cpu_us = 0;  // of the server, per response
};

Rate rate_of(const TrapezeServer& server, const std::vector<std::string>& requests, int status,
             const HttpLoadOptions& load) {
  const double before = server.cpu_seconds();
  const LoadResult result = load_http(server.port(), requests, load);
  for (const Exchange& exchange : result.exchanges) {
    if (exchange.status != status) {
      throw std::runtime_error("answered by " + std::to_string(exchange.status) + ", not by " +
                               std::to_string(status));
    }
  }
  const auto answers = static_cast<double>(result.exchanges.size());
  return {answers / result.seconds, 1e6 * (server.cpu_seconds() - before) / answers};
}

/// Requests that are only answered with the tile if it has changed.
std::vector<std::string> conditional_requests(const Trip& trip,
                                              const std::vector<std::string>& entity_tags) {
  std::vector<std::string> requests;
  for (std::size_t i = 0; i < trip.tiles.size(); ++i) {
    const Trip one{trip.name, trip.layers, {trip.tiles[i]}};
    requests.push_back(tile_requests(one, "If-None-Match: " + entity_tags[i] + "\r\n").front());
  }
  return requests;
}

class RendererFigures {
 public:
  RendererFigures(const Trip& trip, const std::string& renderer)
      : trip_(trip),
        cold_(trip.name + "/trapeze-" + renderer + "/cold"),
        alone_(trip.name + "/trapeze-" + renderer + "/alone"),
        warm_(trip.name + "/trapeze-" + renderer + "/warm"),
        known_(trip.name + "/trapeze-" + renderer + "/known") {}

  void measure(const TrapezeOptions& trapeze, const Options& options) {
    const HttpLoadOptions load{.connections = options.connections, .pipeline = options.pipeline};
    {
      const TrapezeServer server(trip_.layers, trapeze);
      cold_.add(uncached_run(server, trip_, load, options.repeat));
    }
    measure_known(trapeze, options, load);
    const TrapezeServer server(trip_.layers, trapeze);
    alone_.add(uncached_run(server, trip_, {.connections = 1}, options.repeat));
    known_.set("seconds to ready", server.seconds_to_ready());
  }

  void append_to(std::vector<Figure>& figures) const {
    for (const Figure* figure : {&cold_, &alone_, &warm_, &known_}) figures.push_back(*figure);
  }

 private:
  void measure_known(TrapezeOptions trapeze, const Options& options, HttpLoadOptions load) {
    trapeze.keeps_tiles = true;
    const TrapezeServer server(trip_.layers, trapeze);
    const auto requests = tile_requests(trip_);
    load_http(server.port(), requests, load);
    load.keep_entity_tags = true;
    const double before = server.cpu_seconds();
    const LoadResult again = load_http(server.port(), requests, load);
    TileRun run = tile_run(trip_, again, false);
    run.cpu_seconds = server.cpu_seconds() - before;
    warm_.add(std::move(run));
    load.keep_entity_tags = false;
    load.seconds = options.seconds;
    keep_best("cached tiles", rate_of(server, requests, 200, load));
    const auto conditional = conditional_requests(trip_, again.entity_tags);
    keep_best("304", rate_of(server, conditional, 304, load));
    measure_first(trapeze, conditional);
  }

  void measure_first(const TrapezeOptions& trapeze, const std::vector<std::string>& conditional) {
    const TrapezeServer server(trip_.layers, trapeze);
    const double before = server.cpu_seconds();
    std::vector<double> times;
    for (const Exchange& exchange :
         load_http(server.port(), conditional, {.connections = 1}).exchanges) {
      if (exchange.status != 304) throw std::runtime_error("a tile is not what it was");
      times.push_back(1000 * exchange.ms);
    }
    const auto count = static_cast<double>(times.size());
    known_.set("first, cpu us", 1e6 * (server.cpu_seconds() - before) / count);
    const Percentiles percentiles = percentiles_of(std::move(times));
    known_.set("first, p50 us", percentiles.p50);
    known_.set("first, p99 us", percentiles.p99);
  }

  void keep_best(const std::string& what, const Rate& rate) {
    const auto known = known_.values().find(what + "/s");
    if (known != known_.values().end() && known->second >= rate.per_second) return;
    known_.set(what + "/s", rate.per_second);
    known_.set(what + ", cpu us", rate.cpu_us);
  }

  const Trip& trip_;
  Figure cold_;
  Figure alone_;
  Figure warm_;
  Figure known_;
};

void print(const Figure& figure) {
  print_line(figure);
  if (figure.name().ends_with("/alone")) print_zooms(figure);
}

/// Only sends load to a server that is already running.
void load_running_server(const Options& options) {
  for (const std::string& name : options.trips) {
    const Trip trip = named_trip(name, real_data_folder());
    const auto requests = uncached_requests(trip, options.repeat);
    Figure figure(trip.name + "/running/cold");
    figure.add(
        tile_run(trip,
                 load_http(options.port, requests,
                           {.connections = options.connections, .pipeline = options.pipeline}),
                 true));
    print_line(figure);
    print_zooms(figure);
  }
}

void measure_all(const Options& options, const std::string& command) {
  std::vector<Figure> figures;
  for (const std::string& name : options.trips) {
    const Trip trip = named_trip(name, real_data_folder());
    std::vector<RendererFigures> renderers;
    for (const std::string& renderer : options.renderers) renderers.emplace_back(trip, renderer);
    for (int round = 0; round < options.rounds; ++round) {
      for (std::size_t i = 0; i < renderers.size(); ++i) {
        renderers[i].measure({options.program, options.renderers[i], options.more}, options);
      }
    }
    const std::size_t first = figures.size();
    for (const RendererFigures& renderer : renderers) renderer.append_to(figures);
    for (std::size_t i = first; i < figures.size(); ++i) print(figures[i]);
  }
  write_figures(figures, command, options.json);
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app("Trips over real maps (TRAPEZE_DATA), asked of trapeze over HTTP");
  app.add_option("--trip", options.trips, "Which ones")
      ->delimiter(',')
      ->check(CLI::IsMember(options.trips))
      ->capture_default_str();
  app.add_option("--renderer", options.renderers, "What draws: egl, osmesa, software, auto")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--server", options.program, "The program trapeze")->capture_default_str();
  app.add_option("--rounds", options.rounds, "How often all is measured")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--repeat", options.repeat,
                 "How often a round goes through the trip; 0: so that there are 1,500 tiles")
      ->check(CLI::Range(0, 500));
  app.add_option("--connections", options.connections)
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--pipeline", options.pipeline, "Requests that a connection sends ahead")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--seconds", options.seconds, "For the rates of what is known")
      ->capture_default_str();
  app.add_option("--port", options.port,
                 "Start nothing, but ask the server on this port, which has the layers");
  app.add_option("--json", options.json, "Where the figures go")->capture_default_str();
  app.add_option("SERVE_ARGUMENT", options.more, "After --: for `trapeze serve`");
  CLI11_PARSE(app, argc, argv);
  print_table_head();
  if (options.port != 0) {
    load_running_server(options);
  } else {
    measure_all(options, command_line(argc, argv));
  }
  return 0;
}

}  // namespace
}  // namespace trapeze

int main(int argc, char** argv) {
  return trapeze::run_program("trip_bench", trapeze::run, argc, argv);
}
