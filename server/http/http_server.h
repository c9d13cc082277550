// HTTP/1.1 over TCP: connections, timeouts, limits, and orderly shutdown. The responses come from a
// handler, for instance a Site.
//
// Sockets are read and written by a pool of I/O threads, which never draw. Responses may come from
// any thread and are handed back to the connection's own executor.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/base/defaults.h"
#include "server/base/limits.h"
#include "server/http/client_address.h"
#include "server/http/http_message.h"

namespace trapeze {

struct HttpServerOptions {
  std::string address{defaults::kAddress};  // IPv4 or IPv6 address, not a name
  std::uint16_t port = defaults::kPort;     // 0: any free port
  unsigned threads = defaults::kThreads;
  std::size_t max_connections = defaults::kConnections;  // more are refused with 503
  // More connections from one address (for IPv6, one /64) are refused with 429. Connections of
  // trusted proxies are not counted, as they serve many clients.
  std::size_t max_connections_per_address = defaults::kConnectionsPerAddress;
  std::size_t target_limit = kMaxTargetLength;          // bytes of path and query together
  std::uint32_t header_limit = defaults::kHeaderBytes;  // bytes of request line and header together
  std::uint32_t body_limit = defaults::kBodyBytes;      // bytes, for posted styles
  // A path that accepts longer bodies, of which there is room for only a few at the same time;
  // empty: none.
  std::string long_body_path = {};
  std::uint32_t long_body_limit = 0;
  std::chrono::milliseconds idle_timeout = defaults::kIdleTimeout;  // until a request begins
  std::chrono::milliseconds read_timeout =
      defaults::kReadTimeout;  // from its first byte to its last
  std::chrono::milliseconds write_timeout = defaults::kWriteTimeout;  // for a whole response
  // From the call of stop() until no more connections are accepted, so that load balancers notice
  // is_stopping().
  std::chrono::milliseconds drain_delay{0};
  std::chrono::milliseconds drain_timeout =
      defaults::kDrainTimeout;                // after that, for pending requests
  std::vector<AddressRange> trusted_proxies;  // whose X-Forwarded-For is believed
  // Whether scripts of any origin may read responses that do not come from the handler, such as
  // 413, see allow_every_origin().
  bool is_for_every_origin = false;
};

/// Answers a request by calling `respond` exactly once, within this call or later, from any thread.
using Handler = std::function<void(const HttpRequest& request, Respond respond)>;

/// What can be reported about a response that is about to be sent. The references are valid during
/// the call only.
struct Answered {
  const HttpRequest& request;  // empty except for the client if it could not be read
  const HttpResponse& response;
  std::chrono::duration<double> duration;  // since the request was read
  unsigned version;                        // of HTTP: 11 or 10
  std::string_view referer;                // as sent
  std::string_view user_agent;             // as sent
};
/// Called by the I/O threads, possibly by several at the same time.
using Observer = std::function<void(const Answered& answered)>;

/// Why this process may not listen on the port, whether or not it is free: ports below 1024 may be
/// reserved to root. Empty if it may.
std::string find_port_problem(const std::string& address, std::uint16_t port);

class HttpServer {
 public:
  /// Opens the socket, so that clients can connect from then on. Throws std::runtime_error with
  /// address and port if that fails. Everything that `handler` and `observer` refer to must outlive
  /// the server; `observer` may be empty.
  HttpServer(const HttpServerOptions& options, Handler handler, Observer observer = {});
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// The port that was opened.
  std::uint16_t port() const;

  /// The number of open connections. From any thread.
  std::size_t connections() const;
  /// The number of connections refused so far. From any thread.
  std::uint64_t refusals() const;

  /// Serves until stop() is called and all requests pending then have been answered, or the drain
  /// timeout has passed. Call it once. Throws std::system_error if its threads cannot be started.
  void run();

  /// After the drain delay, no more connections and requests are accepted, and run() returns once
  /// pending requests are answered. A second call skips the delay; a third one aborts pending
  /// requests as well. From any thread.
  void stop();
  /// Whether stop() was called. From any thread.
  bool is_stopping() const;

  /// Calls stop() when the process receives SIGTERM or SIGINT. Call before run().
  void stop_on_signals();
  /// Calls `act`, from an I/O thread, when the process receives SIGHUP. Call before run().
  void act_on_hangup(std::function<void()> act);

 private:
  class Connection;
  class State;
  std::shared_ptr<State> state_;
};

}  // namespace trapeze
