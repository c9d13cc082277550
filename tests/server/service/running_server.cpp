#include "tests/server/service/running_server.h"

#include <utility>

namespace trapeze::testing {

RunningServer::RunningServer(HttpServerOptions options, SiteOptions site, StaticFiles files,
                             Observer observer)
    : sample_(/*is_loaded=*/true, std::move(files), std::move(site)) {
  options.address = "127.0.0.1";
  options.port = 0;
  server_ = std::make_unique<HttpServer>(options, sample_.handler(), std::move(observer));
  thread_ = std::thread([this] { server_->run(); });
}

RunningServer::~RunningServer() {
  for (int i = 0; i < 3; ++i) server_->stop();  // repeated calls do no harm
  thread_.join();
}

}  // namespace trapeze::testing
