#include "server/service/service.h"

#include <fmt/format.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "server/http/static_files.h"
#include "server/tiles/open_fonts.h"
#include "server/tiles/read_tile_matrix_set.h"
#include "server/tiles/start_renderers.h"

namespace trapeze {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kEnd{200};  // for reading to end, at most

/// The built-in viewer, or the one in a folder that is configured instead.
StaticFiles open_viewer(const std::string& root) {
  if (root.empty()) return StaticFiles(viewer_files());
  StaticFiles files(root);
  spdlog::info(fmt::format("viewer: {} files of {}", files.size(), root));
  return files;
}

std::string why_no_viewer(const std::string& root) {
  if (!root.empty()) return "There is no viewer here: web_root has no index.html.";
  return "There is no viewer here: this program was built without it (TRAPEZE_VIEWER), and "
         "web_root is not set.";
}

SiteOptions site_options(const Config& config) {
  SiteOptions options;
  options.public_url = config.server.public_url;
  options.allowed_hosts = config.server.allowed_hosts;
  options.cache_control = config.server.cache_control;
  options.sets =
      std::make_shared<const TileMatrixSets>(tile_matrix_sets_with(config.server.tile_matrix_sets));
  options.viewer = config.viewer;
  options.styles = config.styles;
  for (const auto& [name, fonts] : config.fonts) options.label_fonts.push_back(name);
  options.posted_styles = std::size_t{config.server.posted_styles_mb} << 20;
  options.max_layers = config.limits.layers;
  options.max_scale = config.limits.scale;
  options.max_zoom = config.limits.zoom;
  options.map_pixels = config.limits.map_pixels;
  options.values_rows = config.limits.values_rows;
  options.posted_values = std::size_t{config.limits.values_mb} << 20;
  options.drawn_per_second = config.limits.drawn_per_second;
  options.drawn_burst = config.limits.drawn_burst;
  options.tile_cost = config.limits.tile_cost;
  options.cost_per_second = config.limits.cost_per_second;
  options.cost_burst = config.limits.cost_burst;
  return options;
}

/// The URL of the server on this machine. An address that listens on all interfaces cannot be
/// opened, but localhost can.
std::string local_url(const std::string& listening, std::uint16_t port) {
  if (listening == "0.0.0.0" || listening == "::" || listening == "127.0.0.1") {
    return fmt::format("http://localhost:{}/", port);
  }
  if (listening.find(':') != std::string::npos) {
    return fmt::format("http://[{}]:{}/", listening, port);
  }
  return fmt::format("http://{}:{}/", listening, port);
}

HttpServerOptions server_options(const Config& config) {
  HttpServerOptions options;
  options.address = config.server.address;
  options.port = config.server.port;
  options.threads = config.server.threads;
  options.max_connections = config.limits.connections;
  options.max_connections_per_address = config.limits.connections_per_address;
  options.target_limit = config.limits.target_bytes;
  options.header_limit = config.limits.header_bytes;
  options.body_limit = config.limits.body_bytes;
  options.long_body_path = "/values";
  options.long_body_limit = config.limits.values_bytes;
  options.idle_timeout = milliseconds(config.limits.idle_timeout_ms);
  options.read_timeout = milliseconds(config.limits.read_timeout_ms);
  options.write_timeout = milliseconds(config.limits.write_timeout_ms);
  options.drain_delay = milliseconds(config.server.drain_delay_ms);
  options.drain_timeout = milliseconds(config.server.drain_timeout_ms);
  options.trusted_proxies = config.server.trusted_proxies;
  options.is_for_every_origin = true;
  return options;
}

bool is_loopback(const std::string& address) {
  return address == "::1" || address.starts_with("127.");
}

/// What everyone who can reach the server may do, if other machines can reach it.
std::vector<std::string> what_is_open(const Config& config) {
  std::vector<std::string> open;
  if (is_loopback(config.server.address)) return open;
  if (config.limits.tile_cost == 0) open.emplace_back("tiles of any cost (limits.tile_cost = 0)");
  if (config.limits.cost_per_second == 0) {
    open.emplace_back("any number of expensive tiles (limits.cost_per_second = 0)");
  }
  if (config.limits.drawn_per_second == 0) {
    open.emplace_back("any number of ordinary tiles (limits.drawn_per_second = 0)");
  }
  if (config.server.posted_styles_mb > 0) {
    open.emplace_back("posting styles (server.posted_styles_mb)");
  }
  if (config.limits.values_mb > 0) open.emplace_back("posting tables (limits.values_mb)");
  if (config.server.metrics) open.emplace_back("/metrics (server.metrics)");
  if (config.server.public_url.empty() && config.server.allowed_hosts.empty()) {
    open.emplace_back("any Host (server.public_url, server.allowed_hosts)");
  }
  return open;
}

void log_answer(const Answered& answered) {
  if (!spdlog::should_log(spdlog::level::debug)) return;
  spdlog::debug(access_line(answered, LogFormat::text));
}

}  // namespace

Service::Service(const Config& config, LayerSource source)
    : cache_budget_(std::size_t{config.server.cache_mb} << 20),
      queue_limit_(config.server.queue),
      cache_(cache_budget_) {
  if (!config.log.access.empty()) {
    access_log_ = std::make_unique<AccessLog>(config.log.access, config.log.access_format);
  }
  StaticFiles files = open_viewer(config.server.web_root);
  const bool has_viewer = files.find("/") != nullptr;
  if (!has_viewer) spdlog::info(why_no_viewer(config.server.web_root));
  TileServiceOptions drawing;
  drawing.queue = config.server.queue;
  drawing.deadline = milliseconds(config.server.deadline_ms);
  drawing.batch = config.server.batch;
  drawing.fonts = open_fonts(config.text.fonts);
  drawing.labels = std::make_shared<LabelBook>(open_font_choice(config, drawing.fonts));
  drawing.find_kept = [this](const std::string& fingerprint) { return cache_.find(fingerprint); };
  drawing.observe = [this](const TileAnswer& tile) { metrics_.count(tile); };
  auto renderers = start_renderers(config.server.renderer, renderer_count(config.server.workers));
  warm_up(renderers);
  tiles_ = std::make_unique<TileService>(drawing, std::move(renderers));
  SiteOptions options = site_options(config);
  options.fonts = drawing.fonts;
  options.why_no_viewer = why_no_viewer(config.server.web_root);
  if (config.server.metrics) options.metrics = [this] { return metrics_text(); };
  options.loading = [this] { return reloader_->progress(); };
  options.is_stopping = [this] { return server_->is_stopping(); };
  site_ = std::make_unique<Site>(std::move(options), std::move(files), data_, *tiles_, cache_);
  open_server(config);
  address_to_open_ = has_viewer
                         ? fmt::format("open {}", local_url(config.server.address, server_->port()))
                         : fmt::format("the layers are at {}catalog",
                                       local_url(config.server.address, server_->port()));
  if (const auto zooms = parse_zooms(config.changes.zooms)) {
    ChangeLog::Options what;
    what.zooms = *zooms;
    what.most_scale = config.limits.scale;
    what.command = config.changes.command;
    what.labels = drawing.labels;
    changes_ = std::make_unique<ChangeLog>(std::move(what));
  } else if (!config.changes.command.empty()) {
    spdlog::warn("changes.command is never run: it needs changes.zooms");
  }
  if (config.admin.port != 0) open_admin(config);
  reloader_ = std::make_unique<Reloader>(
      std::move(source),
      Reloader::Pace{milliseconds(config.server.watch_ms), milliseconds(config.server.live_ms)},
      data_, *tiles_, metrics_, changes_.get(), [this] { server_->stop(); },
      [this] { spdlog::info(address_to_open_); });
}

Service::~Service() = default;

void Service::open_server(const Config& config) {
  server_ = std::make_unique<HttpServer>(
      server_options(config),
      [this](const HttpRequest& request, Respond respond) {
        site_->handle(request, std::move(respond));
      },
      [this](const Answered& answered) { observe(answered); });
  where_.push_back(fmt::format("listening on {} port {}, {} I/O threads", config.server.address,
                               server_->port(), config.server.threads));
  if (const auto open = what_is_open(config); !open.empty()) {
    where_.push_back(fmt::format("open to everybody who reaches it: {}", fmt::join(open, ", ")));
  }
}

void Service::open_admin(const Config& config) {
  admin_site_ = std::make_unique<AdminSite>(
      AdminSite::Sources{[this] { return figures(); }, [this] { return reloader_->last_problem(); },
                         [this] { return metrics_text(); }, changes_.get()});
  HttpServerOptions options;
  options.address = config.admin.address;
  options.port = config.admin.port;
  options.threads = 1;
  options.drain_timeout = milliseconds(1000);
  admin_ = std::make_unique<HttpServer>(options,
                                        [this](const HttpRequest& request, const Respond& respond) {
                                          respond(admin_site_->answer(request));
                                        });
  where_.push_back(fmt::format("for those who run the server: listening on {} port {} too",
                               config.admin.address, admin_->port()));
}

void Service::act_on_signals() {
  server_->stop_on_signals();
  server_->act_on_hangup([this] {
    spdlog::info("SIGHUP");
    reload();
  });
}

// The addresses are logged only now, because whoever reads them may send a signal immediately.
void Service::run() {
  for (const std::string& line : where_) spdlog::info(line);
  reloader_->start();  // its first messages follow these
  // Runs as long as the main server, so that the shutdown can be observed.
  std::thread admin;
  if (admin_ != nullptr) admin = std::thread([this] { admin_->run(); });
  const auto end_admin = [this, &admin] {
    if (admin_ == nullptr) return;
    admin_->stop();
    admin.join();
  };
  try {
    server_->run();
  } catch (...) {
    end_admin();
    throw;
  }
  end_admin();
  reloader_->rethrow_failure();
}

bool Service::finish() {
  const bool has_read = reloader_->end(kEnd) && !tiles_->is_placing();
  if (changes_ != nullptr) changes_->end_command();
  if (has_read && (changes_ == nullptr || !changes_->is_comparing())) return true;
  if (access_log_ != nullptr) access_log_->flush();
  return false;
}

void Service::reload() {
  if (access_log_ != nullptr) access_log_->reopen();
  reloader_->reload();
}

ServerFigures Service::figures() const {
  ServerFigures figures;
  figures.data = data_.get();
  figures.cache = cache_.figures();
  figures.cache_budget = cache_budget_;
  figures.tiles = tiles_->figures();
  figures.queue_limit = queue_limit_;
  figures.connections = server_->connections();
  figures.refused_connections = server_->refusals();
  figures.renderer = tiles_->renderer_name();
  figures.is_stopping = server_->is_stopping();
  return figures;
}

std::string Service::metrics_text() const {
  return metrics_.text(figures());
}

void Service::observe(const Answered& answered) {
  metrics_.count(answered);
  if (access_log_ != nullptr) access_log_->write(answered);
  log_answer(answered);
}

}  // namespace trapeze
