// A whole server: layers, workers, cache, sites and sockets, put together as configured.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/changes/change_log.h"
#include "server/config/config.h"
#include "server/data/dataset.h"
#include "server/http/http_server.h"
#include "server/service/access_log.h"
#include "server/service/admin_site.h"
#include "server/service/metrics.h"
#include "server/service/reloader.h"
#include "server/service/site.h"
#include "server/tiles/tile_cache.h"
#include "server/tiles/tile_service.h"

namespace trapeze {

class Service {
 public:
  /// Opens the sockets of a server of the layers that `source` names. Throws
  /// std::runtime_error if a socket, the renderer, the viewer or the log of requests does not work.
  Service(const Config& config, LayerSource source);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  std::uint16_t port() const { return server_->port(); }

  /// Acts on SIGTERM and SIGINT (ends, in order) and SIGHUP (reads the layers again, and opens the
  /// log of requests again). Call before run().
  void act_on_signals();

  /// Reads the layers, and serves until stop() is called. Throws what went wrong if the layers
  /// cannot be read.
  void run();
  /// From any thread.
  void stop() { server_->stop(); }
  /// Reads the layers again, and opens the log of requests again. From any thread.
  void reload();

  /// After run(): ends what goes on beside requests. False if layers are still being read, or
  /// labels placed, which cannot be interrupted: then the service must not be destroyed, but all it
  /// has logged has been written and no command for changes runs any more.
  bool finish();

  /// Whether layers are being read at this moment.
  bool is_loading() const { return reloader_->is_loading(); }

 private:
  ServerFigures figures() const;
  std::string metrics_text() const;
  void observe(const Answered& answered);
  void open_server(const Config& config);
  void open_admin(const Config& config);

  const std::size_t cache_budget_;
  const std::size_t queue_limit_;
  Metrics metrics_;
  std::unique_ptr<AccessLog> access_log_;  // null: there is none
  CurrentDataset data_;
  TileCache cache_;
  std::unique_ptr<TileService> tiles_;
  std::unique_ptr<Site> site_;
  std::vector<std::string> where_;  // it listens, for the log
  std::unique_ptr<HttpServer> server_;
  std::unique_ptr<ChangeLog> changes_;     // null if changes are not looked for
  std::unique_ptr<AdminSite> admin_site_;  // these two are null if there is no admin address
  std::unique_ptr<HttpServer> admin_;
  std::string address_to_open_;
  std::unique_ptr<Reloader> reloader_;
};

}  // namespace trapeze
