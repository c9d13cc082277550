// HTTP/1.1 over TCP around a Site: connections, timeouts, limits, and an orderly end.
//
// Sockets are read and written by a pool of I/O threads, which never draw; the site's answers may
// come from any thread and are handed back to the connection's own executor.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "server/site.h"

namespace trapeze {

struct HttpServerOptions {
  std::string address = "0.0.0.0";  // IPv4 or IPv6, no name
  std::uint16_t port = 8080;        // 0: any free port
  unsigned threads = 2;
  std::size_t max_connections = 1024;              // more are turned away with 503
  std::uint32_t header_limit = 8192;               // bytes of request line and header together
  std::uint32_t body_limit = 16 * 1024;            // styles are posted
  std::chrono::milliseconds read_timeout{30'000};  // for a whole request, idle time before included
  std::chrono::milliseconds write_timeout{30'000};  // for a whole response
  std::chrono::milliseconds drain_timeout{10'000};  // for what runs when the server is stopped
};

class HttpServer {
 public:
  /// Opens the socket: from here on clients can connect. Throws std::runtime_error that names
  /// address and port if that fails. `site` outlives the server.
  HttpServer(const HttpServerOptions& options, const Site& site);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// The port that was opened.
  std::uint16_t port() const;

  /// Serves until stop() is called and what was running then has been answered (or the drain
  /// timeout has passed). Call it once.
  void run();

  /// No more connections and requests; run() returns when what is under way is done. A second call
  /// ends that too. From any thread.
  void stop();

  /// Calls stop() when the process receives SIGTERM or SIGINT. Call before run().
  void stop_on_signals();

 private:
  class Connection;
  class State;
  std::shared_ptr<State> state_;
};

}  // namespace trapeze
