#include "bench/measure/http_load.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace trapeze {
namespace {

using ::testing::ElementsAre;

/// Responds to the requests of one connection, one after another, a few bytes at a time.
class SlowServer {
 public:
  using Answer = std::function<std::string(const std::string& request)>;

  SlowServer(Answer answer, std::size_t bytes_at_a_time)
      : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    listen(listener_, 1);
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this, answer = std::move(answer), bytes_at_a_time] {
      const int socket = accept(listener_, nullptr, nullptr);
      serve(socket, answer, bytes_at_a_time);
      close(socket);
    });
  }
  ~SlowServer() {
    thread_.join();
    close(listener_);
  }
  SlowServer(const SlowServer&) = delete;
  SlowServer& operator=(const SlowServer&) = delete;

  std::uint16_t port() const { return port_; }

 private:
  static void serve(int socket, const Answer& answer, std::size_t bytes_at_a_time) {
    std::string received;
    std::array<char, 4096> block{};
    for (ssize_t count; (count = recv(socket, block.data(), block.size(), 0)) > 0;) {
      received.append(block.data(), static_cast<std::size_t>(count));
      for (std::size_t end; (end = received.find("\r\n\r\n")) != std::string::npos;) {
        const std::string bytes = answer(received.substr(0, end));
        received.erase(0, end + 4);
        if (bytes.empty()) return;
        for (std::size_t i = 0; i < bytes.size(); i += bytes_at_a_time) {
          const std::string part = bytes.substr(i, bytes_at_a_time);
          send(socket, part.data(), part.size(), MSG_NOSIGNAL);
          std::this_thread::yield();
        }
      }
    }
  }

  int listener_;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

std::string path_of(const std::string& request) {
  return request.substr(4, request.find(' ', 4) - 4);
}

std::string echo(const std::string& request) {
  const std::string body = path_of(request);
  return "HTTP/1.1 200 OK\r\netag: \"" + body +
         "\"\r\nX-Cache: " + (body == "/b" ? "HIT" : "MISS") +
         "\r\nCONTENT-LENGTH:  " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

const std::vector<std::string> kThree{http_request("/a"), http_request("/b"),
                                      http_request("/long")};

TEST(HttpLoadTest, TakesAnswersApartHoweverTheyArrive) {
  for (const std::size_t bytes_at_a_time : {1, 7, 100000}) {
    const SlowServer server(echo, bytes_at_a_time);
    const LoadResult result =
        load_http(server.port(), kThree,
                  {.connections = 1, .pipeline = 3, .keep_bodies = true, .keep_entity_tags = true});
    EXPECT_THAT(result.bodies, ElementsAre("/a", "/b", "/long"));
    EXPECT_THAT(result.entity_tags, ElementsAre("\"/a\"", "\"/b\"", "\"/long\""));
    ASSERT_EQ(result.exchanges.size(), 3u);
    EXPECT_FALSE(result.exchanges[0].from_cache);
    EXPECT_TRUE(result.exchanges[1].from_cache);
    EXPECT_EQ(result.exchanges[2].bytes, 5u);
    EXPECT_EQ(result.exchanges[2].status, 200);
    EXPECT_FALSE(result.exchanges[2].is_png);
  }
}

TEST(HttpLoadTest, NotModifiedHasNoBodyWhateverItsLengthSays) {
  const SlowServer server(
      [](const std::string&) {
        return std::string("HTTP/1.1 304 Not Modified\r\nContent-Length: 99\r\n\r\n");
      },
      100);
  const LoadResult result = load_http(server.port(), kThree, {.connections = 1});
  ASSERT_EQ(result.exchanges.size(), 3u);
  EXPECT_EQ(result.exchanges[2].status, 304);
  EXPECT_EQ(result.exchanges[2].bytes, 0u);
}

TEST(HttpLoadTest, AsksForSoLongAsItIsTold) {
  const SlowServer server(echo, 1000);
  const LoadResult result = load_http(server.port(), kThree, {.connections = 1, .seconds = 0.2});
  EXPECT_GE(result.seconds, 0.2);
  EXPECT_GT(result.exchanges.size(), kThree.size());
  EXPECT_EQ(result.exchanges[3].request, 0u);
}

TEST(HttpLoadTest, RefusesAnAnswerOfUnknownLength) {
  const SlowServer server([](const std::string&) { return std::string("HTTP/1.1 200 OK\r\n\r\n"); },
                          1000);
  EXPECT_THROW(load_http(server.port(), kThree, {.connections = 1}), std::runtime_error);
}

TEST(HttpLoadTest, NoticesThatTheServerHangsUp) {
  const SlowServer server([](const std::string&) { return std::string(); }, 1);
  EXPECT_THROW(load_http(server.port(), kThree, {.connections = 1}), std::runtime_error);
}

}  // namespace
}  // namespace trapeze
