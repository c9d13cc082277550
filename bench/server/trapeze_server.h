// The server under test: `trapeze serve` as a child process, and the requests of a trip.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/measure/child_process.h"
#include "bench/measure/figures.h"
#include "bench/measure/http_load.h"
#include "bench/measure/trip.h"

namespace trapeze {

/// A temporary folder, removed with this object.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

struct TrapezeOptions {
  std::string program;              // trapeze
  std::string renderer = "auto";    // as for --renderer
  std::vector<std::string> more{};  // further arguments of `serve`
  bool keeps_tiles = false;         // whether it has a cache; otherwise every tile is drawn
};

/// The program `trapeze` of the build that this program belongs to.
std::string built_trapeze();

class TrapezeServer {
 public:
  /// Starts it on a free port with the layers and their colours; returns when it is ready. Throws
  /// std::runtime_error, with the path of its log, if it exits before.
  TrapezeServer(std::span<const TripLayer> layers, const TrapezeOptions& options);

  std::uint16_t port() const { return port_; }
  double cpu_seconds() const { return process_->cpu_seconds(); }
  double seconds_to_ready() const { return seconds_to_ready_; }

 private:
  void await_ready();

  ScratchFolder folder_;
  std::uint16_t port_;
  double seconds_to_ready_ = 0;
  std::unique_ptr<ChildProcess> process_;
};

/// Requests for the tiles of a trip, all layers in each, in the layers' own colours.
std::vector<std::string> tile_requests(const Trip& trip, const std::string& more_headers = {});

/// Requests for the trip, `repeats` times, or, for 0, often enough for a meaningful number of tiles
/// (1,500). None can be answered with a tile drawn for another one: repeated tiles are requested in
/// a slightly different colour of the lowest layer, beginning with colour number `first`; number 0
/// is the layer's own. Throws std::runtime_error if there are not enough colours (kColours).
constexpr int kColours = 512;
std::vector<std::string> uncached_requests(const Trip& trip, int repeats = 0, int first = 0);

/// The times of the tiles of a trip. Throws std::runtime_error unless all responses have status 200
/// and, if `uncached`, were drawn for the request.
TileRun tile_run(const Trip& trip, const LoadResult& result, bool uncached);

/// Sends uncached_requests(), and measures the processor time of the server.
TileRun uncached_run(const TrapezeServer& server, const Trip& trip, const HttpLoadOptions& load,
                     int repeats = 0);

}  // namespace trapeze
