#include "bench/measure/http_load.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace trapeze {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPatienceMs = 30'000;

double ms_between(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double, std::milli>(end - begin).count();
}

/// A file descriptor that is closed with its owner.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {
    if (number < 0) throw std::runtime_error("there are no more file descriptors");
  }
  ~Descriptor() { close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return number_; }

 private:
  int number_;
};

struct Head {
  std::size_t size = 0;  // including the empty line
  std::uint16_t status = 0;
  std::size_t length = 0;  // of the body
  bool from_cache = false;
  std::string_view entity_tag;
};

bool is_name(std::string_view line, std::string_view lower_case) {
  return line.size() > lower_case.size() && line[lower_case.size()] == ':' &&
         std::equal(lower_case.begin(), lower_case.end(), line.begin(), [](char want, char have) {
           return want == (have >= 'A' && have <= 'Z' ? static_cast<char>(have - 'A' + 'a') : have);
         });
}

std::string_view value_of(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t", line.find(':') + 1);
  return begin == std::string_view::npos ? std::string_view() : line.substr(begin);
}

template <typename Number>
Number number_from(std::string_view text) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end == text.data()) {
    throw std::runtime_error("the server sends what is not HTTP: " + std::string(text));
  }
  return number;
}

/// Nothing if the head is not complete yet.
std::optional<Head> parse_head(std::string_view text) {
  const std::size_t end = text.find("\r\n\r\n");
  if (end == std::string_view::npos) return std::nullopt;
  Head head;
  head.size = end + 4;
  head.status = number_from<std::uint16_t>(text.substr(std::min<std::size_t>(9, end), 3));
  const bool has_body = head.status != 304 && head.status != 204;
  bool has_length = false;
  for (std::size_t begin = text.find("\r\n") + 2; begin < end;) {
    const std::size_t line_end = text.find("\r\n", begin);
    const std::string_view line = text.substr(begin, line_end - begin);
    begin = line_end + 2;
    if (is_name(line, "content-length")) {
      head.length = has_body ? number_from<std::size_t>(value_of(line)) : 0;
      has_length = true;
    } else if (is_name(line, "etag")) {
      head.entity_tag = value_of(line);
    } else if (is_name(line, "x-cache")) {
      head.from_cache = value_of(line).starts_with("HIT");
    }
  }
  if (has_body && !has_length) throw std::runtime_error("an answer has no Content-Length");
  return head;
}

class Connection {
 public:
  explicit Connection(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const int on = 1;
    setsockopt(socket_.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("nothing listens on port " + std::to_string(port));
    }
  }

  int descriptor() const { return socket_.get(); }
  std::size_t waiting() const { return asked_.size(); }

  void ask(std::uint32_t request, std::string_view bytes) {
    asked_.push_back({request, Clock::now()});
    while (!bytes.empty()) {
      const ssize_t sent = send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) throw std::runtime_error("the server hung up");
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
  }

  /// Reads the available data and passes every complete response to `take(exchange, head, body)`.
  template <typename Take>
  void receive(const Take& take) {
    std::array<char, 65536> block;
    const ssize_t count = recv(socket_.get(), block.data(), block.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (count <= 0) throw std::runtime_error("the server hung up");
    const auto now = Clock::now();
    const std::string_view fresh(block.data(), static_cast<std::size_t>(count));
    if (received_.empty()) {
      received_ = fresh.substr(take_answers(fresh, now, take));
    } else {
      received_.append(fresh);
      received_.erase(0, take_answers(received_, now, take));
    }
  }

 private:
  struct Asked {
    std::uint32_t request = 0;
    Clock::time_point when;
  };

  /// Returns how many bytes of the text were complete responses.
  template <typename Take>
  std::size_t take_answers(std::string_view text, Clock::time_point now, const Take& take) {
    std::size_t done = 0;
    while (const auto head = parse_head(text.substr(done))) {
      const std::size_t size = head->size + head->length;
      if (text.size() - done < size) break;
      if (asked_.empty()) throw std::runtime_error("the server answers what nobody asked");
      const std::string_view body = text.substr(done + head->size, head->length);
      const Exchange exchange{asked_.front().request,
                              head->status,
                              head->from_cache,
                              body.starts_with("\x89PNG"),
                              static_cast<float>(ms_between(asked_.front().when, now)),
                              static_cast<std::uint32_t>(head->length)};
      asked_.pop_front();
      take(exchange, *head, body);
      done += size;
    }
    return done;
  }

  Descriptor socket_;
  std::deque<Asked> asked_;
  std::string received_;  // the beginning of a response
};

/// Hands out the indexes of the requests until the end.
class Schedule {
 public:
  Schedule(std::size_t count, double seconds) : count_(count), seconds_(seconds) {}

  std::optional<std::uint32_t> next() {
    if (seconds_ == 0 && given_ == count_) return std::nullopt;
    if (seconds_ > 0 && ms_between(begin_, Clock::now()) > 1000 * seconds_) return std::nullopt;
    return static_cast<std::uint32_t>(given_++ % count_);
  }
  double seconds_passed() const { return ms_between(begin_, Clock::now()) / 1000; }

 private:
  const std::size_t count_;
  const double seconds_;
  std::size_t given_ = 0;
  const Clock::time_point begin_ = Clock::now();
};

}  // namespace

std::string http_request(const std::string& target, const std::string& more_headers) {
  return "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n" + more_headers + "\r\n";
}

LoadResult load_http(std::uint16_t port, std::span<const std::string> requests,
                     const HttpLoadOptions& options) {
  LoadResult result;
  if (requests.empty()) return result;
  if (options.keep_bodies) result.bodies.resize(requests.size());
  if (options.keep_entity_tags) result.entity_tags.resize(requests.size());

  const Descriptor poll(epoll_create1(EPOLL_CLOEXEC));
  std::vector<std::unique_ptr<Connection>> connections;
  for (int i = 0; i < options.connections; ++i) {
    connections.push_back(std::make_unique<Connection>(port));
    epoll_event event{EPOLLIN, {.ptr = connections.back().get()}};
    epoll_ctl(poll.get(), EPOLL_CTL_ADD, connections.back()->descriptor(), &event);
  }

  Schedule schedule(requests.size(), options.seconds);
  std::size_t waiting = 0;
  const auto ask_more = [&](Connection& connection) {
    while (connection.waiting() < static_cast<std::size_t>(options.pipeline)) {
      const auto request = schedule.next();
      if (!request) return;
      connection.ask(*request, requests[*request]);
      ++waiting;
    }
  };
  const auto take = [&](const Exchange& exchange, const Head& head, std::string_view body) {
    --waiting;
    result.exchanges.push_back(exchange);
    if (options.keep_bodies) result.bodies[exchange.request] = body;
    if (options.keep_entity_tags) result.entity_tags[exchange.request] = head.entity_tag;
  };

  for (const auto& connection : connections) ask_more(*connection);
  std::array<epoll_event, 64> events;
  while (waiting > 0) {
    const int count = epoll_wait(poll.get(), events.data(), events.size(), kPatienceMs);
    if (count == 0) throw std::runtime_error("the server does not answer");
    for (int i = 0; i < count; ++i) {
      auto& connection = *static_cast<Connection*>(events[static_cast<std::size_t>(i)].data.ptr);
      connection.receive(take);
      ask_more(connection);
    }
  }
  result.seconds = schedule.seconds_passed();
  return result;
}

}  // namespace trapeze
