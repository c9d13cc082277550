#include "server/http/http_server.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/http/raw_client.h"
#include "tests/server/service/sample_site.h"

namespace trapeze {
namespace {

using namespace std::chrono_literals;
using namespace std::string_literals;
using testing::RawClient;
using testing::RawResponse;

class HttpServerTest : public ::testing::Test {
 protected:
  ~HttpServerTest() override { stop(); }

  void start(HttpServerOptions options = {}) {
    options.address = "127.0.0.1";
    options.port = 0;
    server_ = std::make_unique<HttpServer>(options, sample_->handler());
    thread_ = std::thread([this] { server_->run(); });
  }

  void stop() {
    if (!thread_.joinable()) return;
    server_->stop();
    thread_.join();
  }

  std::uint16_t port() const { return server_->port(); }

  std::unique_ptr<testing::SampleSite> sample_ = std::make_unique<testing::SampleSite>();
  std::unique_ptr<HttpServer> server_;
  std::thread thread_;
};

TEST(FindPortProblemTest, APortThatIsReservedToRootIsAProblemThoughItIsFree) {
  int first = 0;  // port that every process may open
  std::ifstream("/proc/sys/net/ipv4/ip_unprivileged_port_start") >> first;
  EXPECT_EQ(find_port_problem("127.0.0.1", 0), "");
  if (geteuid() == 0 || first <= 1) GTEST_SKIP() << "this process may open all ports";
  const auto reserved = static_cast<std::uint16_t>(first - 1);
  EXPECT_THAT(find_port_problem("127.0.0.1", reserved), ::testing::HasSubstr("cannot listen on"));
}

TEST_F(HttpServerTest, ServesSeveralRequestsOverOneConnection) {
  start();
  RawClient client(port());
  const RawResponse tile = client.get("/tiles/rings/0/0/0.png");
  EXPECT_EQ(tile.status, 200);
  EXPECT_EQ(tile.body.substr(1, 3), "PNG");
  EXPECT_EQ(tile.headers.at("content-type"), "image/png");
  EXPECT_EQ(client.get("/nosuch").status, 404);
  EXPECT_EQ(client.get("/health").status, 200);
  EXPECT_EQ(client.get("/tiles/rings/0/0/0.png").body, tile.body);
}

/// A server that holds its answers back until the test releases them or the client has
/// disconnected.
class DisconnectionTest : public ::testing::Test {
 protected:
  DisconnectionTest()
      : server_(options(), [this](const auto& request, Respond respond) {
          request.disconnection->act([this] { has_gone_.set_value(); });
          respond_ = std::move(respond);
          asked_.set_value();
        }) {}
  ~DisconnectionTest() override {
    answer();
    server_.stop();
    thread_.join();
  }

  static HttpServerOptions options() {
    HttpServerOptions options;
    options.address = "127.0.0.1";
    options.port = 0;
    return options;
  }
  void ask(const RawClient& client) {
    client.send("GET /x HTTP/1.1\r\nHost: a\r\n\r\n");
    asked_.get_future().wait();
  }
  void answer() {
    if (!is_answered_) respond_({});
    is_answered_ = true;
  }

  std::promise<void> has_gone_;
  std::promise<void> asked_;
  Respond respond_;
  bool is_answered_ = false;
  HttpServer server_;
  std::thread thread_{[this] { server_.run(); }};
};

TEST_F(DisconnectionTest, AClientThatGoesIsNoticed) {
  {
    const RawClient client(server_.port());
    ask(client);
  }
  EXPECT_EQ(has_gone_.get_future().wait_for(10s), std::future_status::ready);
}

TEST_F(DisconnectionTest, OneThatHasSaidAllStillGetsWhatComesAtOnce) {
  RawClient client(server_.port());
  ask(client);
  client.end_sending();
  answer();
  EXPECT_EQ(client.receive().status, 200);
}

TEST_F(HttpServerTest, AnswersPipelinedRequestsInOrder) {
  start();
  RawClient client(port());
  std::string requests;
  // Tiles take a worker's time and the other requests take none; answers still must not overtake.
  for (int x = 0; x < 8; ++x) {
    requests += "GET /tiles/rings/3/" + std::to_string(x) + "/4.png HTTP/1.1\r\nHost: a\r\n\r\n";
    requests += "GET /nosuch" + std::to_string(x) + " HTTP/1.1\r\nHost: a\r\n\r\n";
    requests += "HEAD /health HTTP/1.1\r\nHost: a\r\n\r\n";
  }
  client.send(requests);
  for (int x = 0; x < 8; ++x) {
    const RawResponse tile = client.receive();
    EXPECT_EQ(tile.status, 200);
    EXPECT_EQ(tile.headers.at("etag"),
              sample_->get("/tiles/rings/3/" + std::to_string(x) + "/4.png").header("ETag"));
    EXPECT_EQ(client.receive().status, 404);
    EXPECT_EQ(client.receive(/*is_head=*/true).status, 200);
  }
}

TEST_F(HttpServerTest, HeadIsGetWithoutTheBody) {
  start();
  for (const char* target : {"/tiles/rings/0/0/0.png", "/catalog", "/nosuch"}) {
    RawClient client(port());
    const RawResponse get = client.get(target);
    client.send(std::string("HEAD ") + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const RawResponse head = client.receive(/*is_head=*/true);
    EXPECT_EQ(head.status, get.status);
    EXPECT_EQ(head.headers.at("content-length"), std::to_string(get.body.size()));
    EXPECT_EQ(head.headers.at("content-type"), get.headers.at("content-type"));
    EXPECT_EQ(client.get("/health").status, 200) << "no stray body follows";
  }
}

TEST_F(HttpServerTest, NotModifiedHasNoBodyAndKeepsTheConnection) {
  start();
  RawClient client(port());
  const std::string tag = client.get("/tiles/rings/0/0/0.png").headers.at("etag");
  const RawResponse again = client.get("/tiles/rings/0/0/0.png", "If-None-Match: " + tag + "\r\n");
  EXPECT_EQ(again.status, 304);
  EXPECT_EQ(again.headers.at("etag"), tag);
  const std::string two_fields = "If-None-Match: \"x\"\r\nIf-None-Match: " + tag + "\r\n";
  EXPECT_EQ(client.get("/tiles/rings/0/0/0.png", two_fields).status, 304);
  EXPECT_EQ(client.get("/health").status, 200);
}

TEST_F(HttpServerTest, ClosesWhenAskedTo) {
  start();
  RawClient client(port());
  const RawResponse response = client.get("/health", "Connection: close\r\n");
  EXPECT_EQ(response.headers.at("connection"), "close");
  EXPECT_TRUE(client.is_closed_within(5s));
  RawClient client_of_two(port());
  client_of_two.get("/health", "Connection: TE\r\nConnection: close\r\n");
  EXPECT_TRUE(client_of_two.is_closed_within(5s));
  RawClient old_client(port());
  old_client.send("GET /health HTTP/1.0\r\n\r\n");
  EXPECT_EQ(old_client.receive().status, 200);
  EXPECT_TRUE(old_client.is_closed_within(5s));
}

TEST_F(HttpServerTest, EveryOriginMayReadWhyARequestIsRefusedUnread) {
  HttpServerOptions options;
  options.is_for_every_origin = true;
  start(options);
  for (const std::string& request :
       {"GET /" + std::string(5000, 'x') + " HTTP/1.1\r\nHost: a\r\n\r\n",
        "GET /health HTTP/1.1\r\nHost: a\r\nX: " + std::string(9000, 'x') + "\r\n\r\n",
        "POST /styles HTTP/1.1\r\nHost: a\r\nContent-Length: 2000000\r\n\r\n"s,
        "GET /health HTTP/1.1\r\n\r\n"s}) {
    RawClient client(port());
    client.send(request);
    const RawResponse refused = client.receive();
    EXPECT_GE(refused.status, 400);
    EXPECT_EQ(refused.headers.at("access-control-allow-origin"), "*") << refused.status;
  }
}

TEST_F(HttpServerTest, TheHostOfAnAbsoluteTargetReplacesThatOfTheHeader) {
  start();
  RawClient client(port());
  const RawResponse response = client.get("http://right.example:81/tiles/rings.json");
  EXPECT_EQ(response.status, 200);
  EXPECT_THAT(response.body, ::testing::HasSubstr("\"http://right.example:81/tiles/rings/{z}"));
}

TEST_F(HttpServerTest, EmptyLinesBeforeARequestAreSkipped) {
  start();
  RawClient client(port());
  client.send("\r\n");
  client.send("POST /styles HTTP/1.1\r\nHost: a\r\nContent-Length: 2\r\n\r\n{}\r\n");
  EXPECT_EQ(client.receive().status, 201);
  EXPECT_EQ(client.get("/health").status, 200);
}

TEST_F(HttpServerTest, OtherMethodsAreToldWhatIsAllowed) {
  start();
  RawClient client(port());
  client.send("DELETE /tiles/rings/0/0/0.png HTTP/1.1\r\nHost: a\r\n\r\n");
  const RawResponse refused = client.receive();
  EXPECT_EQ(refused.status, 405);
  EXPECT_EQ(refused.headers.at("allow"), "GET, HEAD, OPTIONS");
  client.send("POST /catalog HTTP/1.1\r\nHost: a\r\nContent-Length: 2\r\n\r\n{}");
  EXPECT_EQ(client.receive().status, 405);
  client.send("OPTIONS /catalog HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(client.receive().status, 204);
}

TEST_F(HttpServerTest, AClientThatAsksMaySendItsBody) {
  start();
  RawClient client(port());
  const std::string header =
      "POST /styles HTTP/1.1\r\nHost: a\r\nExpect: 100-continue\r\nContent-Length: ";
  const std::string style = R"({"fill": "teal"})";
  client.send(header + std::to_string(style.size()) + "\r\n\r\n");
  EXPECT_EQ(client.receive(true).status, 100);
  client.send(style);
  EXPECT_EQ(client.receive().status, 201);
  // A body that is too long is refused before it is sent.
  client.send(header + "2000000\r\n\r\n");
  EXPECT_EQ(client.receive().status, 413);
}

TEST_F(HttpServerTest, RefusesWhatIsTooLongAndSaysSo) {
  start();
  const std::string line = "GET /health HTTP/1.1\r\nHost: a\r\n";
  {
    RawClient client(port());
    client.send(line + "X: " + std::string(9000, 'x') + "\r\n\r\n");
    EXPECT_EQ(client.receive().status, 431);
    EXPECT_TRUE(client.is_closed_within(5s));
  }
  {
    RawClient client(port());
    client.send("GET /" + std::string(5000, 'x') + " HTTP/1.1\r\nHost: a\r\n\r\n");
    EXPECT_EQ(client.receive().status, 414);
  }
  {
    RawClient client(port());
    client.send("GET /" + std::string(20000, 'x') + " HTTP/1.1\r\nHost: a\r\n\r\n");
    EXPECT_EQ(client.receive().status, 414);
  }
  {
    RawClient client(port());
    client.send("POST /health HTTP/1.1\r\nHost: a\r\nContent-Length: 2000000\r\n\r\n");
    EXPECT_EQ(client.receive().status, 413);
  }
  RawClient client(port());
  client.send("POST /health HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n1fffff\r\n" +
              std::string(0x1fffff, 'x') + "\r\n");
  EXPECT_EQ(client.receive().status, 413);
}

TEST_F(HttpServerTest, RefusesWhatIsNotHttp) {
  start();
  for (const std::string& request :
       {std::string("\x16\x03\x01\x02 hello TLS\r\n\r\n"), std::string("GET\r\n\r\n"),
        std::string("GET /health HTTP/9.9\r\nHost: a\r\n\r\n"),
        std::string("GET /health HTTP/1.1\r\n\r\n"),
        std::string("GET /health HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n"),
        std::string("GET /health HTTP/1.1\r\nHost: a\r\nContent-Length: x\r\n\r\n"),
        "GET /hea\0lth HTTP/1.1\r\nHost: a\r\n\r\n"s}) {
    RawClient client(port());
    client.send(request);
    EXPECT_EQ(client.receive().status, 400) << request;
    EXPECT_TRUE(client.is_closed_within(5s));
  }
  EXPECT_EQ(RawClient(port()).get("/health").status, 200);
}

TEST_F(HttpServerTest, SlowAndSilentClientsAreLetGo) {
  HttpServerOptions options;
  options.idle_timeout = 300ms;
  options.read_timeout = 300ms;
  start(options);
  RawClient silent(port());
  RawClient slow(port());
  slow.send("GET /health HT");
  // A byte now and then does not extend the time: the limit applies to the request as a whole.
  bool is_closed = false;
  for (int i = 0; i < 50 && !is_closed; ++i) {
    slow.send("T");
    is_closed = slow.is_closed_within(100ms);
  }
  EXPECT_TRUE(is_closed);
  EXPECT_TRUE(silent.is_closed_within(5s));
}

TEST_F(HttpServerTest, AClientThatReadsNothingIsLetGo) {
  // More than the buffers between the two can hold, so that writing stalls.
  constexpr std::size_t kSize = std::size_t{30} << 20;
  const std::string root = ::testing::TempDir() + "/http_server_test_root";
  std::filesystem::create_directories(root);
  std::ofstream(root + "/large.txt") << std::string(kSize, 'x');
  sample_ = std::make_unique<testing::SampleSite>(true, StaticFiles(root));
  std::filesystem::remove_all(root);
  HttpServerOptions options;
  options.write_timeout = 300ms;
  start(options);
  RawClient deaf(port());
  deaf.send("GET /large.txt HTTP/1.1\r\nHost: a\r\n\r\n");
  std::this_thread::sleep_for(1s);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_LT(deaf.receive_all().size(), kSize);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 5s) << "it was closed, not left waiting";
}

TEST_F(HttpServerTest, ConnectionsBeyondTheLimitAreTurnedAway) {
  HttpServerOptions options;
  options.max_connections = 2;
  start(options);
  RawClient first(port());
  EXPECT_EQ(first.get("/health").status, 200);
  {
    RawClient second(port());
    EXPECT_EQ(second.get("/health").status, 200);
    RawClient third(port());
    const RawResponse refused = third.receive();
    EXPECT_EQ(refused.status, 503);
    EXPECT_EQ(refused.headers.at("retry-after"), "1");
  }
  EXPECT_EQ(first.get("/health").status, 200);
  // Clients that disconnect make room again.
  int status = 503;
  for (int attempt = 0; attempt < 100 && status == 503; ++attempt) {
    std::this_thread::sleep_for(50ms);
    status = RawClient(port()).get("/health").status;
  }
  EXPECT_EQ(status, 200);
}

TEST_F(HttpServerTest, StoppingFinishesWhatWasAskedAndTakesNoMore) {
  start();
  RawClient idle(port());
  EXPECT_EQ(idle.get("/health").status, 200);
  RawClient half(port());
  half.send("GET /tiles/rings/0/0/0.png HTTP/1.1\r\n");
  std::this_thread::sleep_for(100ms);
  const std::uint16_t old_port = port();
  server_->stop();
  EXPECT_TRUE(idle.is_closed_within(5s));
  EXPECT_THROW(RawClient client(old_port), std::runtime_error);
  half.send("Host: a\r\n\r\n");
  const RawResponse response = half.receive();
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.headers.at("connection"), "close");
  thread_.join();
}

TEST_F(HttpServerTest, StoppingDoesNotWaitForeverForASlowClient) {
  HttpServerOptions options;
  options.drain_timeout = 200ms;
  start(options);
  RawClient half(port());
  half.send("GET /health HTTP/1.1\r\n");
  std::this_thread::sleep_for(100ms);
  const auto begin = std::chrono::steady_clock::now();
  stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 5s);
}

TEST_F(HttpServerTest, APortInUseIsAnErrorThatNamesIt) {
  start();
  HttpServerOptions options;
  options.address = "127.0.0.1";
  options.port = port();
  try {
    HttpServer second(options, sample_->handler());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr(std::to_string(port())));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("in use"));
  }
}

TEST_F(HttpServerTest, AnAddressThatIsNoneIsAnError) {
  HttpServerOptions options;
  options.address = "localhost!";
  EXPECT_THROW(HttpServer(options, sample_->handler()), std::runtime_error);
}

TEST_F(HttpServerTest, ManyClientsGetTheirOwnAnswers) {
  HttpServerOptions options;
  options.threads = 4;
  start(options);
  std::vector<std::thread> clients;
  std::atomic<int> wrong = 0;
  for (int i = 0; i < 8; ++i) {
    clients.emplace_back([this, i, &wrong] {
      RawClient client(port());
      for (int n = 0; n < 50; ++n) {
        const std::string target = "/tiles/rings/4/" + std::to_string((i + n) % 16) + "/5.png";
        const auto tag = client.get(target).headers.at("etag");
        wrong += tag != sample_->get(target).header("ETag");
      }
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace trapeze
