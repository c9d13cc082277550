// Asks an HTTP server of this machine for many things over few connections, and notes how long each
// took. One thread, so that it takes little of the cores that the server runs on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace trapeze {

struct HttpLoadOptions {
  int connections = 16;  // kept alive; each waits for its answer before it asks again
  int pipeline = 1;      // requests that one connection sends ahead
  double seconds = 0;    // asks for all requests again and again for so long; 0: once for each
  bool keep_bodies = false;
  bool keep_entity_tags = false;
};

struct Exchange {
  std::uint32_t request = 0;  // its number among the requests
  std::uint16_t status = 0;
  bool from_cache = false;  // X-Cache says HIT
  bool is_png = false;      // the body begins like one
  float ms = 0;             // from sending to the last byte of the answer
  std::uint32_t bytes = 0;  // of the body
};

struct LoadResult {
  double seconds = 0;                    // from the first request to the last answer
  std::vector<Exchange> exchanges;       // in the order of the answers
  std::vector<std::string> bodies;       // by request, if kept
  std::vector<std::string> entity_tags;  // by request, if kept
};

/// The bytes of a request for a target, such as "/tiles/a/0/0/0.png"; `more_headers` end with CRLF.
std::string http_request(const std::string& target, const std::string& more_headers = {});

/// Sends the requests, from the first to the last, over whichever connection is free. Throws
/// std::runtime_error if the server is not there, hangs up, stays silent for half a minute, or does
/// not say how long its answers are.
LoadResult load_http(std::uint16_t port, std::span<const std::string> requests,
                     const HttpLoadOptions& options);

}  // namespace trapeze
