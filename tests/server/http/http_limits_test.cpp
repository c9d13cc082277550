// Limits of the server, and clients that break the rules.
#include <gmock/gmock.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/http/raw_client.h"
#include "tests/server/service/hostile_requests.h"
#include "tests/server/service/running_server.h"

namespace trapeze {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::RawClient;
using testing::RawResponse;
using testing::RunningServer;

constexpr const char* kTile = "/tiles/rings/0/0/0.png";
constexpr std::size_t kHostileRequests = 10'000;

/// The response that the next client gets when it connects and sends nothing.
RawResponse greeting(std::uint16_t port, const std::string& from) {
  return RawClient(port, from).receive();
}

TEST(HttpLimitsTest, OneAddressCannotHaveAllConnections) {
  HttpServerOptions options;
  options.max_connections_per_address = 2;
  RunningServer server(options);
  RawClient first(server.port());
  RawClient second(server.port());
  EXPECT_EQ(first.get("/health").status, 200);
  EXPECT_EQ(second.get("/health").status, 200);
  const RawResponse refused = greeting(server.port(), "127.0.0.1");
  EXPECT_EQ(refused.status, 429);
  EXPECT_EQ(refused.headers.at("retry-after"), "1");
  EXPECT_THAT(refused.body, HasSubstr("from your address"));
  EXPECT_EQ(RawClient(server.port(), "127.0.0.2").get("/health").status, 200);
  EXPECT_EQ(server.server().refusals(), 1u);
}

TEST(HttpLimitsTest, ATrustedProxyMayHaveAllConnections) {
  HttpServerOptions options;
  options.max_connections_per_address = 1;
  options.trusted_proxies = {parse_address_range("127.0.0.1").value()};
  RunningServer server(options);
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 5; ++i) {
    clients.push_back(std::make_unique<RawClient>(server.port()));
    EXPECT_EQ(clients.back()->get("/health").status, 200);
  }
}

TEST(HttpLimitsTest, TargetAndHeaderAreAsLongAsConfigured) {
  HttpServerOptions options;
  options.target_limit = 200;
  options.header_limit = 1000;
  RunningServer server(options);
  const auto status_of = [&server](const std::string& target, std::size_t header) {
    return RawClient(server.port()).get(target, "X: " + std::string(header, 'x') + "\r\n").status;
  };
  const std::string tile = std::string(kTile) + "?debug=";
  const std::string longest = tile + std::string(200 - tile.size(), ',');
  EXPECT_EQ(status_of(longest, 1), 400) << "too long is something else than wrong";
  EXPECT_EQ(status_of(longest + ",", 1), 414);
  EXPECT_EQ(status_of(kTile, 800), 200);
  EXPECT_EQ(status_of(kTile, 1000), 431);
}

TEST(HttpLimitsTest, ManyShortFieldsAreAsLongAsOneLongField) {
  HttpServerOptions options;
  options.header_limit = 1000;
  RunningServer server(options);
  const auto status_with = [&server](int fields) {
    std::string header;
    for (int i = 0; i < fields; ++i) header += "X: y\r\n";
    return RawClient(server.port()).get("/health", header).status;
  };
  EXPECT_EQ(status_with(150), 200);
  EXPECT_EQ(status_with(200), 431);
  EXPECT_EQ(status_with(9000), 431);
}

TEST(HttpLimitsTest, LayersScaleAndZoomAreAsConfigured) {
  SiteOptions site;
  site.max_layers = 1;
  site.max_scale = 2;
  site.max_zoom = 3;
  RunningServer server({}, site);
  const auto get = [&server](const std::string& target) { return server.sample().get(target); };
  EXPECT_EQ(get("/tiles/rings/3/4/4@2x.png").status, 200);
  const HttpResponse scale = get("/tiles/rings/3/4/4@3x.png");
  EXPECT_EQ(scale.status, 400);
  EXPECT_THAT(*scale.body, AllOf(HasSubstr("\"scale\""), HasSubstr("1x to 2x")));
  const HttpResponse layers = get("/tiles/rings,west/3/4/4.png");
  EXPECT_EQ(layers.status, 400);
  EXPECT_THAT(*layers.body, AllOf(HasSubstr("\"layers\""), HasSubstr("at most 1 layers")));
  const HttpResponse zoom = get("/tiles/rings/4/4/4.png");
  EXPECT_EQ(zoom.status, 404);
  EXPECT_THAT(*zoom.body, HasSubstr("zoom is 0 to 3"));
}

TEST(HttpLimitsTest, DrawnTilesOfAnAddressAreLimitedAndKeptOnesAreNot) {
  SiteOptions site;
  site.drawn_per_second = 0.001;
  site.drawn_burst = 3;
  RunningServer server({}, site);
  RawClient client(server.port());
  for (int x = 0; x < 3; ++x) {
    EXPECT_EQ(client.get("/tiles/rings/2/" + std::to_string(x) + "/1.png").status, 200);
  }
  const RawResponse refused = client.get("/tiles/rings/2/3/1.png");
  EXPECT_EQ(refused.status, 429);
  EXPECT_EQ(refused.headers.at("retry-after"), "1000");
  EXPECT_THAT(refused.headers.at("content-type"), HasSubstr("problem+json"));
  const RawResponse kept = client.get("/tiles/rings/2/0/1.png");
  EXPECT_EQ(kept.status, 200);
  EXPECT_EQ(
      client.get("/tiles/rings/2/0/1.png", "If-None-Match: " + kept.headers.at("etag") + "\r\n")
          .status,
      304);
  EXPECT_EQ(client.get("/health").status, 200);
  EXPECT_EQ(RawClient(server.port(), "127.0.0.2").get("/tiles/rings/2/3/1.png").status, 200);
}

/// Draws one tile for each client address, and no more for minutes.
SiteOptions one_tile_per_client() {
  SiteOptions site;
  site.drawn_per_second = 0.001;
  site.drawn_burst = 1;
  return site;
}

/// Trusts X-Forwarded-For from 127.0.0.1.
HttpServerOptions behind_local_proxy() {
  HttpServerOptions options;
  options.trusted_proxies = {parse_address_range("127.0.0.1").value()};
  return options;
}

TEST(HttpLimitsTest, BehindATrustedProxyItIsTheClientThatIsLimited) {
  RunningServer server(behind_local_proxy(), one_tile_per_client());
  const auto status_for = [&server](const std::string& from, const std::string& client, int x) {
    return RawClient(server.port(), from)
        .get("/tiles/rings/3/" + std::to_string(x) + "/1.png",
             "X-Forwarded-For: " + client + "\r\n")
        .status;
  };
  EXPECT_EQ(status_for("127.0.0.1", "203.0.113.1", 0), 200);
  EXPECT_EQ(status_for("127.0.0.1", "203.0.113.1", 1), 429);
  EXPECT_EQ(status_for("127.0.0.1", "203.0.113.2", 1), 200);
  EXPECT_EQ(status_for("127.0.0.2", "203.0.113.3", 2), 200);
  EXPECT_EQ(status_for("127.0.0.2", "203.0.113.4", 3), 429) << "who is not trusted cannot lie";
}

TEST(HttpLimitsTest, ATrustedProxyThatReportsNoClientIsNotLimited) {
  RunningServer server(behind_local_proxy(), one_tile_per_client());
  for (int x = 0; x < 4; ++x) {
    const std::string tile = "/tiles/rings/3/" + std::to_string(x) + "/1.png";
    EXPECT_EQ(RawClient(server.port(), "127.0.0.1").get(tile).status, 200);
  }
}

TEST(HttpLimitsTest, WhatIsSentBehindABodyIsNoHeader) {
  RunningServer server(behind_local_proxy(), one_tile_per_client());
  const auto status_for = [&server](const std::string& trailer, int x) {
    RawClient client(server.port());
    client.send("GET /tiles/rings/3/" + std::to_string(x) +
                "/1.png HTTP/1.1\r\nHost: a\r\nX-Forwarded-For: 203.0.113.1\r\n"
                "Transfer-Encoding: chunked\r\n\r\n0\r\n" +
                trailer + "\r\n");
    return client.receive().status;
  };
  EXPECT_EQ(status_for("Host: b\r\n", 0), 200) << "there is one Host header";
  EXPECT_EQ(status_for("X-Forwarded-For: 203.0.113.2\r\n", 1), 429);
}

TEST(HttpLimitsTest, AConnectionMayRestLongerThanARequestMayTake) {
  HttpServerOptions options;
  options.idle_timeout = 10s;
  options.read_timeout = 200ms;
  RunningServer server(options);
  RawClient client(server.port());
  for (int i = 0; i < 2; ++i) {
    std::this_thread::sleep_for(400ms);
    EXPECT_EQ(client.get("/health").status, 200);
  }
  client.send("GET /health HTTP/1.1\r\n");
  EXPECT_TRUE(client.is_closed_within(5s));
}

TEST(HttpLimitsTest, AClientThatSaysItIsDoneStillGetsItsAnswers) {
  RunningServer server;
  RawClient client(server.port());
  client.send(
      "GET /tiles/rings/3/1/1.png HTTP/1.1\r\nHost: a\r\n\r\n"
      "GET /health HTTP/1.1\r\nHost: a\r\n\r\n");
  client.end_sending();
  EXPECT_EQ(client.receive().status, 200);
  EXPECT_EQ(client.receive().body, "{\"status\": \"ok\"}\n");
  EXPECT_EQ(client.receive_all(), "");
}

TEST(HttpLimitsTest, HalfARequestAndGoneHarmsNobody) {
  RunningServer server;
  for (int i = 0; i < 50; ++i) {
    RawClient client(server.port());
    client.send("GET /tiles/rings/5/1/1.png HTTP/1.1\r\nHo");
    if (i % 2 == 0) client.end_sending();
  }
  for (int i = 0; i < 50; ++i) {
    RawClient client(server.port());
    client.send("GET /tiles/rings/6/" + std::to_string(i) + "/1.png HTTP/1.1\r\nHost: a\r\n\r\n");
  }
  EXPECT_EQ(RawClient(server.port()).get(kTile).status, 200);
}

TEST(HttpLimitsTest, ABodyThatNobodyAskedForIsNotTheNextRequest) {
  RunningServer server;
  RawClient client(server.port());
  const std::string smuggled = "GET /nosuch HTTP/1.1\r\nHost: smuggled\r\n\r\n";
  client.send("POST / HTTP/1.1\r\nHost: a\r\nContent-Length: " + std::to_string(smuggled.size()) +
              "\r\n\r\n" + smuggled + "GET /health HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(client.receive().status, 405);
  EXPECT_EQ(client.receive().status, 200);
}

TEST(HttpLimitsTest, ABodyOfWhichNobodyKnowsTheEndIsNotTheNextRequest) {
  RunningServer server;
  const auto statuses_for = [&server](const std::string& version, const std::string& coding) {
    RawClient client(server.port());
    client.send("POST /styles HTTP/" + version + "\r\nHost: a\r\nConnection: keep-alive\r\n" +
                "Transfer-Encoding: " + coding +
                "\r\n\r\nGET /health HTTP/1.1\r\nHost: smuggled\r\n\r\n");
    const std::string all = client.receive_all();
    EXPECT_EQ(all.find("Server: "), all.rfind("Server: ")) << coding << ": " << all;
    return all.substr(9, 3);
  };
  for (const char* coding : {"xchunked", "identity", "chunked, identity", "\"chunked\"", "gzip",
                             "chunked;q=1", "gzip, chunked", "identity, chunked"}) {
    EXPECT_EQ(statuses_for("1.1", coding), "501") << coding;
  }
  EXPECT_EQ(statuses_for("1.0", "chunked"), "400");
  RawClient client(server.port());
  client.send(
      "POST /health HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: Chunked\r\n\r\n0\r\n\r\n"
      "GET /health HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(client.receive().status, 405);
  EXPECT_EQ(client.receive().status, 200);
}

/// A server that accepts long bodies at /values only.
HttpServerOptions with_long_bodies() {
  HttpServerOptions options;
  options.body_limit = 100;
  options.long_body_path = "/values";
  options.long_body_limit = 5000;
  options.max_connections_per_address = 100;
  return options;
}

std::string table_of(std::size_t bytes) {
  std::string table = "key,value\n";
  for (int i = 0; table.size() + 20 < bytes; ++i) table += "key" + std::to_string(i) + ",1\n";
  return table;
}

std::string post(const std::string& target, const std::string& body) {
  return "POST " + target +
         " HTTP/1.1\r\nHost: a\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" +
         body;
}

TEST(HttpLimitsTest, OnlyTablesMayBeLong) {
  RunningServer server(with_long_bodies());
  const auto answer_to = [&server](const std::string& request) {
    RawClient client(server.port());
    client.send(request);
    return client.receive();
  };
  EXPECT_EQ(answer_to(post("/values", table_of(4000))).status, 201);
  EXPECT_EQ(answer_to(post("/values?key=key", table_of(4000))).status, 201);
  const RawResponse long_table = answer_to(post("/values", table_of(6000)));
  EXPECT_EQ(long_table.status, 413);
  EXPECT_THAT(long_table.body, HasSubstr("5000 bytes"));
  const RawResponse long_style =
      answer_to(post("/styles", "{\"fill\": \"" + std::string(200, 'a')));
  EXPECT_EQ(long_style.status, 413);
  EXPECT_THAT(long_style.body, HasSubstr("100 bytes"));
  EXPECT_EQ(answer_to(post("/values/x", table_of(4000))).status, 413);
  // In chunks, whose total length is not known in advance.
  const std::string table = table_of(4000);
  const std::string head = "POST /values HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n";
  std::string chunks;
  for (std::size_t i = 0; i < table.size(); i += 256) {
    const std::string chunk = table.substr(i, 256);
    char size[16];
    std::snprintf(size, sizeof size, "%zx\r\n", chunk.size());
    chunks += size + chunk + "\r\n";
  }
  EXPECT_EQ(answer_to(head + chunks + "0\r\n\r\n").status, 201);
  EXPECT_EQ(answer_to(head + chunks + "7d0\r\n" + std::string(2000, 'a') + "\r\n0\r\n\r\n").status,
            413);
}

TEST(HttpLimitsTest, ThereIsRoomForAFewLongBodiesAtOnce) {
  RunningServer server(with_long_bodies());
  const std::string request = post("/values", table_of(4000));
  // Three requests from one address have begun and do not end.
  std::vector<std::unique_ptr<RawClient>> slow;
  for (int i = 0; i < 3; ++i) {
    slow.push_back(std::make_unique<RawClient>(server.port()));
    slow.back()->send(request.substr(0, request.size() - 1));
  }
  const auto status_from = [&server, &request](const std::string& from) {
    RawClient client(server.port(), from);
    client.send(request);
    return client.receive().status;
  };
  for (int i = 0; i < 100 && status_from("127.0.0.1") != 503; ++i)
    std::this_thread::sleep_for(20ms);
  EXPECT_EQ(status_from("127.0.0.1"), 503);
  EXPECT_EQ(status_from("127.0.0.2"), 201);
  slow.front()->send(request.substr(request.size() - 1));
  EXPECT_EQ(slow.front()->receive().status, 201);
  EXPECT_EQ(status_from("127.0.0.1"), 201);
  slow.clear();
  for (int i = 0; i < 100 && status_from("127.0.0.1") != 201; ++i)
    std::this_thread::sleep_for(20ms);
  EXPECT_EQ(status_from("127.0.0.1"), 201);
}

TEST(HttpLimitsTest, WhenToldToStopItGoesOnForTheDelayButIsNotReady) {
  HttpServerOptions options;
  options.drain_delay = 3s;
  std::optional<RunningServer> server;
  SiteOptions site;
  site.is_stopping = [&server] { return server->server().is_stopping(); };
  server.emplace(options, site);
  RawClient client(server->port());
  EXPECT_EQ(client.get("/ready").status, 200);
  server->server().stop();
  for (int i = 0; i < 100 && client.get("/ready").status == 200; ++i) {
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(client.get("/ready").status, 503);
  EXPECT_EQ(client.get(kTile).status, 200);
  EXPECT_EQ(RawClient(server->port()).get(kTile).status, 200) << "new connections are taken too";
  EXPECT_TRUE(client.is_closed_within(20s));
}

TEST(HttpLimitsTest, TellsWhoAskedForWhatAndWhatBecameOfIt) {
  std::mutex mutex;
  std::vector<std::string> told;
  const Observer observer = [&](const Answered& answered) {
    const std::lock_guard lock(mutex);
    told.push_back(answered.request.method + " " + answered.request.target + " " +
                   std::to_string(answered.response.status) + " " +
                   address_text(answered.request.client) + " " + std::string(answered.user_agent) +
                   (answered.duration.count() >= 0 ? "" : " negative"));
  };
  RunningServer server({}, {}, {}, observer);
  RawClient client(server.port());
  client.get(kTile, "User-Agent: me\r\n");
  client.get("/nosuch");
  client.send("GET\r\n\r\n");
  client.receive();
  const std::lock_guard lock(mutex);
  EXPECT_THAT(told,
              ::testing::ElementsAre(std::string("GET ") + kTile + " 200 127.0.0.1 me",
                                     "GET /nosuch 404 127.0.0.1 ", HasSubstr(" 400 127.0.0.1")));
}

TEST(HostileRequestsTest, NothingOutsideTheFolderOfTheViewerIsServed) {
  const std::string folder = ::testing::TempDir() + "/hostile_requests_test";
  std::filesystem::create_directories(folder + "/root/.hidden");
  std::ofstream(folder + "/secret.txt") << "root:secret";
  std::ofstream(folder + "/root/index.html") << "viewer";
  std::ofstream(folder + "/root/.hidden/a.txt") << "root:hidden";
  RunningServer server({}, {}, StaticFiles(folder + "/root"));
  std::filesystem::create_symlink(folder + "/secret.txt", folder + "/root/late_link.txt");
  std::vector<std::string> targets = testing::hostile_targets();
  for (const char* way : {"/../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt",
                          "/.hidden/a.txt", "/late_link.txt", "/index.html/../../secret.txt"}) {
    targets.emplace_back(way);
  }
  for (const std::string& target : targets) {
    const HttpResponse response = server.sample().get(target);
    EXPECT_THAT(response.status, ::testing::AnyOf(200, 400, 404, 414, 501)) << target;
    ASSERT_NE(response.body, nullptr) << target;
    EXPECT_THAT(*response.body, ::testing::Not(HasSubstr("root:"))) << target;
  }
  std::filesystem::remove_all(folder);
}

/// The status codes of all responses in the bytes received over a connection.
std::vector<int> statuses_in(const std::string& bytes) {
  static const std::regex line("HTTP/1\\.[01] ([0-9]{3}) ");
  std::vector<int> statuses;
  for (std::sregex_iterator found(bytes.begin(), bytes.end(), line), end; found != end; ++found) {
    statuses.push_back(std::stoi((*found)[1]));
  }
  return statuses;
}

TEST(HostileRequestsTest, TenThousandHarmNobody) {
  const std::uint64_t seed = 20'240'607;
  HttpServerOptions options;
  options.read_timeout = 2s;
  RunningServer server(options);
  const std::string good_tag = RawClient(server.port()).get(kTile).headers.at("etag");
  std::map<int, int> counts;
  const auto requests = testing::hostile_requests(kHostileRequests, seed);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    RawClient client(server.port());
    client.send(requests[i]);
    client.end_sending();
    for (const int status : statuses_in(client.receive_all())) {
      ++counts[status];
      if (status == 100) continue;  // the client may send its body
      // 501 is the status that WMTS requires for unsupported operations.
      EXPECT_TRUE((status >= 200 && status < 500) || status == 501)
          << status << ": seed " << seed << ", request " << i << ": " << requests[i].substr(0, 500);
    }
  }
  EXPECT_GT(counts[400], 1000) << "they were told what is wrong";
  EXPECT_GT(counts[200], 100) << "some of them are harmless";
  EXPECT_EQ(RawClient(server.port()).get(kTile).headers.at("etag"), good_tag);
}

}  // namespace
}  // namespace trapeze
