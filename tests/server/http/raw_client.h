// A blocking HTTP client that sends exactly the given bytes and gives up after ten seconds.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace trapeze::testing {

struct RawResponse {
  int status = 0;
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;
};

class RawClient {
 public:
  /// Connects to a port of this machine, from the loopback address `from`. Throws
  /// std::runtime_error if nothing listens there.
  explicit RawClient(std::uint16_t port, const std::string& from = "127.0.0.1");
  ~RawClient();
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  void send(std::string_view bytes) const;
  /// Signals the end of the request stream.
  void end_sending() const;
  /// Reads one response; with `is_head` it has no body, whatever its length header. Throws
  /// std::runtime_error if the connection ends before the response does.
  RawResponse receive(bool is_head = false);
  /// Sends a GET request over this connection and returns the response.
  RawResponse get(const std::string& target, const std::string& more_headers = {});
  /// Reads until the connection ends, or nothing arrives for ten seconds; returns the bytes read.
  std::string receive_all();
  /// Whether the server has closed the connection, or closes it within `patience`.
  bool is_closed_within(std::chrono::milliseconds patience);

 private:
  /// False at the end of the stream.
  bool read_more();

  int socket_ = -1;
  std::string received_;
};

}  // namespace trapeze::testing
