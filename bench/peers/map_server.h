// MapServer over HTTP: lighttpd, with one FastCGI process of mapserv per core behind it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/measure/child_process.h"
#include "bench/measure/trip.h"
#include "bench/server/trapeze_server.h"

namespace trapeze {

class MapServer {
 public:
  /// Needs lighttpd and mapserv. Returns when it responds; throws std::runtime_error if it does
  /// not.
  explicit MapServer(const std::string& map_file);

  std::uint16_t port() const { return port_; }
  /// Requests for the tiles of the trip, with all layers of the map.
  std::vector<std::string> requests(const Trip& trip) const;
  /// Of lighttpd and all mapserv processes.
  double cpu_seconds() const { return process_.cpu_seconds(); }

 private:
  void await_answer();

  const std::string map_file_;
  ScratchFolder folder_;
  std::uint16_t port_;
  ChildProcess process_;
};

}  // namespace trapeze
