// HTTP/1.1 over TCP: connections, timeouts, limits, and an orderly end. What is answered is decided
// by whoever is asked: a Site, for instance.
//
// Sockets are read and written by a pool of I/O threads, which never draw; answers may come from
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
  std::string address{defaults::kAddress};  // IPv4 or IPv6, no name
  std::uint16_t port = defaults::kPort;     // 0: any free port
  unsigned threads = defaults::kThreads;
  std::size_t max_connections = defaults::kConnections;  // more are turned away with 503
  // More from one address (of IPv6: from one /64) are turned away with 429. Not counted are those
  // of trusted proxies, who speak for many.
  std::size_t max_connections_per_address = defaults::kConnectionsPerAddress;
  std::size_t target_limit = kMaxTargetLength;          // bytes of path and query together
  std::uint32_t header_limit = defaults::kHeaderBytes;  // bytes of request line and header together
  std::uint32_t body_limit = defaults::kBodyBytes;      // styles are posted
  // A path to which longer ones are posted, of which there is only room for a few at once; empty:
  // none.
  std::string long_body_path = {};
  std::uint32_t long_body_limit = 0;
  std::chrono::milliseconds idle_timeout = defaults::kIdleTimeout;  // until a request begins
  std::chrono::milliseconds read_timeout =
      defaults::kReadTimeout;  // from its first byte to its last
  std::chrono::milliseconds write_timeout = defaults::kWriteTimeout;  // for a whole response
  // From the call of stop() until no more connections are taken: for balancers to notice that
  // is_stopping().
  std::chrono::milliseconds drain_delay{0};
  std::chrono::milliseconds drain_timeout =
      defaults::kDrainTimeout;                // after that, for what still runs
  std::vector<AddressRange> trusted_proxies;  // whose X-Forwarded-For is believed
};

/// Answers a request by calling `respond` exactly once, within this call or later, from any thread.
using Handler = std::function<void(const HttpRequest& request, Respond respond)>;

/// What there is to tell of an answer, as it is about to be sent. Everything is alive during the
/// call only.
struct Answered {
  const HttpRequest& request;  // all empty but for the client if it could not be read
  const HttpResponse& response;
  std::chrono::duration<double> duration;  // since the request was read
  unsigned version;                        // of HTTP: 11 or 10
  std::string_view referer;                // as sent
  std::string_view user_agent;             // as sent
};
/// Called by the I/O threads, by several at once.
using Observer = std::function<void(const Answered& answered)>;

class HttpServer {
 public:
  /// Opens the socket: from here on clients can connect. Throws std::runtime_error that names
  /// address and port if that fails. What `handler` and `observer` refer to outlives the server;
  /// `observer` may be empty.
  HttpServer(const HttpServerOptions& options, Handler handler, Observer observer = {});
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// The port that was opened.
  std::uint16_t port() const;

  /// Connections that are open. From any thread.
  std::size_t connections() const;
  /// Connections that were turned away so far. From any thread.
  std::uint64_t refusals() const;

  /// Serves until stop() is called and what was running then has been answered (or the drain
  /// timeout has passed). Call it once. Throws std::system_error if its threads cannot be started.
  void run();

  /// After the drain delay no more connections and requests are taken, and run() returns when what
  /// is under way is done. A second call skips the delay, a third ends what is under way too. From
  /// any thread.
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
