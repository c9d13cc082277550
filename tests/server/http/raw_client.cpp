#include "tests/server/http/raw_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace trapeze::testing {
namespace {

constexpr timeval kPatience{10, 0};

RawResponse parse_head(const std::string& head) {
  RawResponse response;
  std::istringstream lines(head);
  std::string line;
  std::getline(lines, line);
  response.status = std::stoi(line.substr(line.find(' ') + 1));
  while (std::getline(lines, line) && line.size() > 1) {
    const std::size_t colon = line.find(':');
    std::string name = line.substr(0, colon);
    std::ranges::transform(name, name.begin(), [](char c) {
      return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    response.headers[name] = line.substr(colon + 2, line.size() - colon - 3);
  }
  return response;
}

}  // namespace

RawClient::RawClient(std::uint16_t port, const std::string& from)
    : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
  setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &kPatience, sizeof kPatience);
  setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &kPatience, sizeof kPatience);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  inet_pton(AF_INET, from.c_str(), &own.sin_addr);
  bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    close(socket_);
    throw std::runtime_error("cannot connect to port " + std::to_string(port));
  }
}

RawClient::~RawClient() {
  close(socket_);
}

void RawClient::send(std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;  // the server may answer and close before it has read everything
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

void RawClient::end_sending() const {
  shutdown(socket_, SHUT_WR);
}

bool RawClient::read_more() {
  std::array<char, 4096> block{};
  const ssize_t count = recv(socket_, block.data(), block.size(), 0);
  if (count <= 0) return false;
  received_.append(block.data(), static_cast<std::size_t>(count));
  return true;
}

RawResponse RawClient::receive(bool is_head) {
  std::size_t end = 0;
  while ((end = received_.find("\r\n\r\n")) == std::string::npos) {
    if (!read_more()) throw std::runtime_error("no response; received: " + received_);
  }
  RawResponse response = parse_head(received_.substr(0, end + 4));
  received_.erase(0, end + 4);
  const auto length = response.headers.find("content-length");
  if (is_head || length == response.headers.end()) return response;
  const std::size_t size = std::stoul(length->second);
  while (received_.size() < size) {
    if (!read_more()) throw std::runtime_error("the response ends early");
  }
  response.body = received_.substr(0, size);
  received_.erase(0, size);
  return response;
}

RawResponse RawClient::get(const std::string& target, const std::string& more_headers) {
  send("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n" + more_headers + "\r\n");
  return receive();
}

std::string RawClient::receive_all() {
  while (read_more()) {
  }
  return std::exchange(received_, {});
}

bool RawClient::is_closed_within(std::chrono::milliseconds patience) {
  pollfd poll_socket{socket_, POLLIN, 0};
  if (poll(&poll_socket, 1, static_cast<int>(patience.count())) <= 0) return false;
  return !read_more();
}

}  // namespace trapeze::testing
