// Sends many requests to an HTTP server on this machine over few connections, and records how long
// each took. Uses one thread, so that most of the cores are left to the server.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace trapeze {

struct HttpLoadOptions {
  int connections = 16;  // keep-alive; each waits for its response before the next request
  int pipeline = 1;      // requests that one connection sends in advance
  double seconds = 0;    // repeats all requests for that long; 0: each is sent once
  bool keep_bodies = false;
  bool keep_entity_tags = false;
};

struct Exchange {
  std::uint32_t request = 0;  // its index among the requests
  std::uint16_t status = 0;
  bool from_cache = false;  // X-Cache is HIT
  bool is_png = false;      // the body begins like a PNG
  float ms = 0;             // from sending to the last byte of the response
  std::uint32_t bytes = 0;  // of the body
};

struct LoadResult {
  double seconds = 0;                    // from the first request to the last response
  std::vector<Exchange> exchanges;       // in the order of the responses
  std::vector<std::string> bodies;       // by request, if kept
  std::vector<std::string> entity_tags;  // by request, if kept
};

/// The bytes of a request for a target, such as "/tiles/a/0/0/0.png"; `more_headers` must end with
/// CRLF.
std::string http_request(const std::string& target, const std::string& more_headers = {});

/// Sends the requests, from the first to the last, each over any free connection. Throws
/// std::runtime_error if the server is not there, closes a connection, stays silent for half a
/// minute, or does not state the length of its responses.
LoadResult load_http(std::uint16_t port, std::span<const std::string> requests,
                     const HttpLoadOptions& options);

}  // namespace trapeze
