// A server over the fixtures, on its own port and in a thread of the test.
#pragma once

#include <cstdint>
#include <memory>
#include <thread>

#include "server/http/http_server.h"
#include "tests/server/service/sample_site.h"

namespace trapeze::testing {

class RunningServer {
 public:
  explicit RunningServer(HttpServerOptions options = {}, SiteOptions site = {},
                         StaticFiles files = {}, Observer observer = {});
  ~RunningServer();
  RunningServer(const RunningServer&) = delete;
  RunningServer& operator=(const RunningServer&) = delete;

  std::uint16_t port() const { return server_->port(); }
  SampleSite& sample() { return sample_; }
  HttpServer& server() { return *server_; }

 private:
  SampleSite sample_;
  std::unique_ptr<HttpServer> server_;
  std::thread thread_;
};

}  // namespace trapeze::testing
