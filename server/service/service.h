// A complete server: layers, workers, cache, sites and sockets, assembled from the configuration.
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
  /// Opens the sockets of a server for the layers of `source`. Throws std::runtime_error if a
  /// socket, the renderer, the viewer or the access log does not work.
  Service(const Config& config, LayerSource source);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  std::uint16_t port() const { return server_->port(); }

  /// Handles SIGTERM and SIGINT (orderly shutdown) and SIGHUP (reads the layers again and reopens
  /// the access log). Call before run().
  void act_on_signals();

  /// Reads the layers, and serves until stop() is called. Throws the error if the layers cannot be
  /// read.
  void run();
  /// From any thread.
  void stop() { server_->stop(); }
  /// Reads the layers again and reopens the access log. From any thread.
  void reload();

  /// Call after run(). Ends all background work. Returns false if layers are still being read or
  /// compared, or labels placed, which cannot be interrupted. In that case the service must not be
  /// destroyed; but everything it has logged has been written, and no command for changes runs any
  /// more.
  bool finish();

  /// Whether layers are being read at the moment.
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
  std::unique_ptr<AccessLog> access_log_;  // null: no access log
  CurrentDataset data_;
  TileCache cache_;
  std::unique_ptr<TileService> tiles_;
  std::unique_ptr<Site> site_;
  std::vector<std::string> where_;  // addresses it listens on, for the log
  std::unique_ptr<HttpServer> server_;
  std::unique_ptr<ChangeLog> changes_;     // null if changes are not computed
  std::unique_ptr<AdminSite> admin_site_;  // these two are null without an admin address
  std::unique_ptr<HttpServer> admin_;
  std::string address_to_open_;
  std::unique_ptr<Reloader> reloader_;
};

}  // namespace trapeze
