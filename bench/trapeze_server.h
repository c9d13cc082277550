// The server under test: `trapeze serve` as a child, and the requests that a trip makes of it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "bench/child_process.h"
#include "bench/figures.h"
#include "bench/http_load.h"
#include "bench/trip.h"

namespace trapeze {

/// A folder of its own in the system's folder for such things, gone with this object.
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
};

/// The program `trapeze` of the build that this program is part of.
std::string built_trapeze();

class TrapezeServer {
 public:
  /// Starts it on a free port with the layers and their colours; returns when it is ready. Throws
  /// std::runtime_error, with where its log is, if it ends before.
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

/// Makes requests none of which can be answered with what was drawn for another: a tile that was
/// asked for before is asked for in a slightly different colour of the lowest layer.
class UncachedRequests {
 public:
  explicit UncachedRequests(const Trip& trip) : trip_(trip) {}

  /// Throws std::runtime_error when there are no more colours, which is after 511 times.
  std::vector<std::string> next();

 private:
  const Trip& trip_;
  std::map<std::tuple<int, std::uint32_t, std::uint32_t>, int> asked_;
};

/// The times of the tiles of a trip. Throws std::runtime_error unless all were answered by 200 and,
/// if `uncached`, drawn for it.
TileRun tile_run(const Trip& trip, const LoadResult& result, bool uncached);

}  // namespace trapeze
