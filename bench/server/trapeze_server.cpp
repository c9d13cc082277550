#include "bench/server/trapeze_server.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <thread>
#include <tuple>

namespace trapeze {
namespace {

std::string write_config(std::span<const TripLayer> layers, bool keeps_tiles,
                         const std::string& folder) {
  const std::string path = folder + "/trapeze.toml";
  std::ofstream file(path);
  if (!keeps_tiles) file << "[server]\ncache_mb = 0\n\n";
  for (const TripLayer& layer : layers) {
    file << "[[layer]]\nname = \"" << layer.name << "\"\nfile = \""
         << std::filesystem::absolute(layer.file).string() << "\"\nstyle = { fill = \"#"
         << layer.colour << "\" }\n\n";
  }
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
  return path;
}

std::string layer_list(const Trip& trip) {
  std::string names;
  for (const TripLayer& layer : trip.layers) names += (names.empty() ? "" : ",") + layer.name;
  return names;
}

/// The colour with other low bits, three in each channel. 0 <= variant < kColours.
std::string varied_colour(const std::string& colour, int variant) {
  const auto number = static_cast<int>(std::stoul(colour, nullptr, 16));
  const int mask = (variant & 7) | (variant >> 3 & 7) << 8 | (variant >> 6 & 7) << 16;
  char text[8];
  std::snprintf(text, sizeof text, "%06x", number ^ mask);
  return text;
}

std::string target_of(const TileId& tile) {
  return "/" + std::to_string(tile.z) + "/" + std::to_string(tile.x) + "/" +
         std::to_string(tile.y) + ".png";
}

/// Makes requests none of which can be answered with a tile drawn for another one: repeated tiles
/// are requested in a slightly different colour of the lowest layer.
class UncachedRequests {
 public:
  UncachedRequests(const Trip& trip, int first) : trip_(trip), first_(first) {}

  /// For all tiles of the trip, once. Throws std::runtime_error when there are no more colours.
  std::vector<std::string> next() {
    const std::string front = "/tiles/" + layer_list(trip_);
    const TripLayer& lowest = trip_.layers.front();
    std::vector<std::string> requests;
    for (const TileId& tile : trip_.tiles) {
      const int variant = first_ + asked_[{tile.z, tile.x, tile.y}]++;
      if (variant >= kColours) throw std::runtime_error("a tile was asked for in every colour");
      std::string target = front + target_of(tile);
      if (variant > 0) {
        target += "?" + lowest.name + ".fill=" + varied_colour(lowest.colour, variant);
      }
      requests.push_back(http_request(target));
    }
    return requests;
  }

 private:
  const Trip& trip_;
  const int first_;
  std::map<std::tuple<int, std::uint32_t, std::uint32_t>, int> asked_;
};

}  // namespace

ScratchFolder::ScratchFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "trapeze-bench-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string built_trapeze() {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / "trapeze")
      .string();
}

TrapezeServer::TrapezeServer(std::span<const TripLayer> layers, const TrapezeOptions& options)
    : port_(free_port()) {
  std::vector<std::string> arguments{
      options.program, "serve",
      "--config",      write_config(layers, options.keeps_tiles, folder_.path()),
      "--address",     "127.0.0.1",
      "--port",        std::to_string(port_),
      "--renderer",    options.renderer};
  arguments.insert(arguments.end(), options.more.begin(), options.more.end());
  process_ = std::make_unique<ChildProcess>(arguments, folder_.path() + "/log");
  await_ready();
}

void TrapezeServer::await_ready() {
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<std::string> request{http_request("/ready")};
  while (process_->is_running()) {
    try {
      if (load_http(port_, request, {.connections = 1}).exchanges.front().status == 200) {
        const auto duration = std::chrono::steady_clock::now() - begin;
        seconds_to_ready_ = std::chrono::duration<double>(duration).count();
        return;
      }
    } catch (const std::exception&) {  // not listening yet
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  std::ifstream log(folder_.path() + "/log");
  throw std::runtime_error("trapeze ended before it was ready:\n" +
                           std::string(std::istreambuf_iterator<char>(log), {}));
}

std::vector<std::string> tile_requests(const Trip& trip, const std::string& more_headers) {
  const std::string front = "/tiles/" + layer_list(trip);
  std::vector<std::string> requests;
  for (const TileId& tile : trip.tiles) {
    requests.push_back(http_request(front + target_of(tile), more_headers));
  }
  return requests;
}

TileRun tile_run(const Trip& trip, const LoadResult& result, bool uncached) {
  TileRun run;
  run.seconds = result.seconds;
  for (const Exchange& exchange : result.exchanges) {
    if (exchange.status != 200) {
      throw std::runtime_error("a tile was answered by " + std::to_string(exchange.status));
    }
    if (!exchange.is_png) throw std::runtime_error("a tile is no picture");
    if (uncached && exchange.from_cache) {
      throw std::runtime_error("a tile that should have been drawn came from the cache");
    }
    run.tiles.push_back({trip.tiles[exchange.request % trip.tiles.size()].z, exchange.ms,
                         static_cast<double>(exchange.bytes)});
  }
  return run;
}

std::vector<std::string> uncached_requests(const Trip& trip, int repeats, int first) {
  constexpr std::size_t kEnough = 1500;
  const std::size_t times = repeats > 0 ? static_cast<std::size_t>(repeats)
                                        : (kEnough + trip.tiles.size() - 1) / trip.tiles.size();
  UncachedRequests source(trip, first);
  std::vector<std::string> requests;
  for (std::size_t i = 0; i < times; ++i) {
    const auto once = source.next();
    requests.insert(requests.end(), once.begin(), once.end());
  }
  return requests;
}

TileRun uncached_run(const TrapezeServer& server, const Trip& trip, const HttpLoadOptions& load,
                     int repeats) {
  const auto requests = uncached_requests(trip, repeats);
  const double before = server.cpu_seconds();
  TileRun run = tile_run(trip, load_http(server.port(), requests, load), true);
  run.cpu_seconds = server.cpu_seconds() - before;
  return run;
}

}  // namespace trapeze
