#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <future>
#include <stdexcept>
#include <thread>
#include <utility>

#include "server/build_id.h"
#include "server/commands.h"
#include "server/config.h"
#include "server/dataset.h"
#include "server/http_server.h"
#include "server/site.h"
#include "server/start_renderers.h"
#include "server/static_files.h"
#include "server/tile_cache.h"
#include "server/tile_service.h"

namespace trapeze {
namespace {

RendererKind renderer_kind_or_throw(const std::string& word) {
  const auto kind = renderer_kind_from(word);
  if (!kind) throw std::runtime_error("--renderer takes auto, egl, osmesa or software");
  return *kind;
}

Config configure(const ServeArguments& arguments) {
  Config config;
  if (!arguments.config.empty()) {
    config = read_config(arguments.config);
    spdlog::info("configuration: {}", arguments.config);
  }
  ServerConfig& server = config.server;
  server.port = arguments.port.value_or(server.port);
  server.address = arguments.address.value_or(server.address);
  server.threads = arguments.threads.value_or(server.threads);
  server.workers = arguments.workers.value_or(server.workers);
  server.web_root = arguments.web_root.value_or(server.web_root);
  server.renderer.device = arguments.device.value_or(server.renderer.device);
  if (arguments.renderer) server.renderer.kind = renderer_kind_or_throw(*arguments.renderer);
  if (server.workers == 0) server.workers = std::max(1u, std::thread::hardware_concurrency());
  if (!arguments.files.empty()) config.layers = layers_of_files(arguments.files);
  if (config.layers.empty()) {
    throw std::runtime_error(
        "there is nothing to serve: name files, or a configuration with "
        "[[layer]] by --config");
  }
  return config;
}

/// Finds out before the socket is open what would only fail after the other files were loaded.
void check_files_exist(const std::vector<LayerConfig>& layers) {
  for (const LayerConfig& layer : layers) {
    const std::string& file = layer.file_to_open();
    const bool is_virtual = file.starts_with("/vsi");  // GDAL's own, within archives
    std::error_code error;
    if (!is_virtual && !std::filesystem::exists(file, error)) {
      throw std::runtime_error(fmt::format("layer \"{}\": there is no file {}", layer.name, file));
    }
  }
}

StaticFiles open_web_root(const std::string& root) {
  if (root.empty()) {
    spdlog::info("no viewer: web_root is not set");
    return {};
  }
  StaticFiles files(root);
  spdlog::info("viewer: {} files of {}", files.size(), root);
  return files;
}

/// Loads in the background while the server runs already; stops the server if it fails.
class Loading {
 public:
  Loading(const std::vector<LayerConfig>& layers, CurrentDataset& data, HttpServer& server)
      : thread_([this, &layers, &data, &server] {
          try {
            data.set(Dataset::load(layers));
            spdlog::info("ready: {} layers, generation {}", layers.size(),
                         data.get()->generation());
            done_.set_value();
          } catch (...) {
            failure_ = std::current_exception();
            done_.set_value();
            server.stop();
          }
        }) {}

  ~Loading() {
    if (thread_.joinable()) thread_.join();
  }

  bool is_done() { return future_.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }
  /// Throws what ended the loading. Only when is_done().
  void rethrow_failure() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::exception_ptr failure_;
  std::promise<void> done_;
  std::future<void> future_ = done_.get_future();
  std::thread thread_;
};

[[noreturn]] void end_now() {
  // Reading a large file cannot be interrupted, and nobody waits for its result any more. The
  // thread that reads must not meet objects that are being destroyed: so none are.
  spdlog::info("stopped while loading");
  std::quick_exit(0);
}

}  // namespace

int run_serve(const ServeArguments& arguments) {
  const Config config = configure(arguments);
  const ServerConfig& options = config.server;
  spdlog::info("trapeze {} (build {})", version(), build_id());
  check_files_exist(config.layers);
  StaticFiles files = open_web_root(options.web_root);

  CurrentDataset data;
  TileCache cache(std::size_t{options.cache_mb} << 20);
  TileService tiles({options.queue, std::chrono::milliseconds(options.deadline_ms), options.batch},
                    start_renderers(options.renderer, static_cast<int>(options.workers)));
  const Site site({options.public_url, options.allowed_hosts, options.cache_control, config.styles,
                   std::size_t{options.posted_styles_mb} << 20},
                  std::move(files), data, tiles, cache);
  HttpServerOptions http;
  http.address = options.address;
  http.port = options.port;
  http.threads = options.threads;
  HttpServer server(http, site);
  server.stop_on_signals();
  spdlog::info("listening on {} port {}, {} I/O threads", options.address, server.port(),
               options.threads);

  Loading loading(config.layers, data, server);
  server.run();
  if (!loading.is_done()) end_now();
  loading.rethrow_failure();
  spdlog::info("stopped");
  return 0;
}

}  // namespace trapeze
