// Sends any bytes to a server that listens on the loopback address: the client receives exactly the
// responses that the server recorded as sent, and the server keeps running.
//
// Input: the bytes of one connection.
#include <spdlog/spdlog.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/http/http_server.h"
#include "tests/fuzz/require.h"

namespace trapeze {
namespace {

using fuzzing::require;

constexpr std::size_t kMaxInput = 16384;  // sockets hold this much without a reader

struct Sent {
  std::string method;
  int status;
  std::size_t bytes;
};

/// libFuzzer checks the time with a SIGALRM every few seconds. The interrupted calls must continue:
/// without this they fail with EINTR, which looks as if the server had closed the connection.
void go_on_after_alarms() {
  struct sigaction action {};
  require(sigaction(SIGALRM, nullptr, &action) == 0, "no signals");
  action.sa_flags |= SA_RESTART;
  require(sigaction(SIGALRM, &action, nullptr) == 0, "no signals");
}

/// A server that answers every request with a few words, and records what it has sent.
class FuzzedServer {
 public:
  FuzzedServer() {
    go_on_after_alarms();
    spdlog::set_level(spdlog::level::off);
    thread_ = std::thread([this] { server_->run(); });
  }
  ~FuzzedServer() {
    server_->stop();
    thread_.join();
  }
  FuzzedServer(const FuzzedServer&) = delete;
  FuzzedServer& operator=(const FuzzedServer&) = delete;

  std::uint16_t port() const { return server_->port(); }
  std::vector<Sent> take_sent() {
    const std::lock_guard lock(mutex_);
    return std::exchange(sent_, {});
  }

 private:
  static HttpServerOptions options() {
    HttpServerOptions options;
    options.address = "127.0.0.1";
    options.port = 0;
    options.threads = 1;
    // So low that short inputs, which are fast, exceed them.
    options.body_limit = 64;
    options.header_limit = 256;
    options.target_limit = 128;
    options.trusted_proxies = {*parse_address_range("127.0.0.0/8")};
    return options;
  }

  static void answer(const HttpRequest& request, const Respond& respond) {
    const auto is_graphic = [](char c) { return static_cast<unsigned char>(c) > ' ' && c != 0x7f; };
    require(std::ranges::all_of(request.method, is_graphic), "a method that is none");
    require(!request.target.empty() && std::ranges::all_of(request.target, is_graphic),
            "a target that is none");
    require(request.body.size() <= options().body_limit, "a body beyond the limit");
    HttpResponse response;
    response.headers = {{"Content-Type", "text/plain"}};
    response.body = std::make_shared<const std::string>("HTTP/1.1 is spoken here.\r\n\r\n");
    respond(std::move(response));
  }

  void observe(const Answered& answered) {
    const std::size_t bytes = answered.response.body == nullptr || answered.request.method == "HEAD"
                                  ? 0
                                  : answered.response.body->size();
    const std::lock_guard lock(mutex_);
    sent_.push_back({answered.request.method, answered.response.status, bytes});
  }

  std::mutex mutex_;  // guards sent_
  std::vector<Sent> sent_;
  const std::unique_ptr<HttpServer> server_ = std::make_unique<HttpServer>(
      options(), answer, [this](const Answered& answered) { observe(answered); });
  std::thread thread_;
};

sockaddr_in loopback(std::uint32_t host, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK + host);
  return address;
}

/// A connection from one of many addresses in turn. A port stays unavailable for a minute after its
/// connection has ended, and one address has too few ports for thousands a second.
int connect_to(std::uint16_t port) {
  static std::uint32_t turn = 0;
  const sockaddr_in from = loopback(turn++ % 200, 0);
  const sockaddr_in to = loopback(0, port);
  const int client = socket(AF_INET, SOCK_STREAM, 0);
  require(client >= 0, "no socket");
  const int late = 1;  // allows ports that are in use with other peers
  setsockopt(client, IPPROTO_IP, IP_BIND_ADDRESS_NO_PORT, &late, sizeof late);
  require(bind(client, reinterpret_cast<const sockaddr*>(&from), sizeof from) == 0, "no address");
  require(connect(client, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0,
          "the server takes no connection");
  return client;
}

/// Sends all bytes on a connection, then only receives.
std::string exchange_bytes(std::uint16_t port, std::string_view bytes) {
  const int client = connect_to(port);
  // Closes with a reset if the server has not closed the connection, so that its port is free
  // immediately.
  const linger reset{1, 0};
  setsockopt(client, SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
  while (!bytes.empty()) {
    const ssize_t count = send(client, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count <= 0) break;  // the server has closed its side
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  shutdown(client, SHUT_WR);
  std::string received;
  std::array<char, 4096> block{};
  for (ssize_t count = 0; (count = recv(client, block.data(), block.size(), 0)) > 0;) {
    received.append(block.data(), static_cast<std::size_t>(count));
  }
  close(client);
  return received;
}

/// Removes one response from the beginning of the received bytes.
void take_answer(const Sent& sent, std::string_view& received) {
  require(received.starts_with("HTTP/1.1 ") || received.starts_with("HTTP/1.0 "),
          "an answer does not begin as one");
  int status = 0;
  std::from_chars(received.data() + 9, received.data() + std::min<std::size_t>(12, received.size()),
                  status);
  require(status == sent.status, "an answer has another status");
  const std::size_t end = received.find("\r\n\r\n");
  require(end != std::string_view::npos, "an answer has no end of its header");
  require(received.size() >= end + 4 + sent.bytes, "an answer is cut short");
  received.remove_prefix(end + 4 + sent.bytes);
}

void check(std::string_view bytes) {
  static FuzzedServer server;
  const std::string all = exchange_bytes(server.port(), bytes.substr(0, kMaxInput));
  std::string_view received = all;
  for (const Sent& sent : server.take_sent()) take_answer(sent, received);
  require(received.empty(), "there is more than the answers");
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trapeze::check(trapeze::fuzzing::text_of(data, size));
  return 0;
}
