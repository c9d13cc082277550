// What every URL answers: requests in, responses out, without a socket.
//
// Thread-safety: handle() may be called from any thread.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/text/fonts.h"
#include "server/base/defaults.h"
#include "server/base/result.h"
#include "server/base/url.h"
#include "server/config/config.h"
#include "server/data/dataset.h"
#include "server/documents/document.h"
#include "server/http/http_message.h"
#include "server/http/rate_limit.h"
#include "server/http/static_files.h"
#include "server/service/document_worker.h"
#include "server/service/known_fingerprints.h"
#include "server/service/known_targets.h"
#include "server/styles/style_book.h"
#include "server/tiles/tile_cache.h"
#include "server/tiles/tile_service.h"
#include "server/tiles/window_request.h"
#include "server/values/value_book.h"

namespace trapeze {

struct SiteOptions {
  /// What documents call this server, without a '/' at the end; empty: by the Host of each request.
  std::string public_url = {};
  /// The Host headers that will do for that, as is_allowed_host() takes them; empty: all.
  std::vector<std::string> allowed_hosts = {};
  /// What caches between here and the client may do with tiles.
  std::string cache_control{defaults::kCacheControl};
  std::size_t max_layers = kMaxLayersPerTile;  // of one tile
  int max_scale = kMaxScale;
  int max_zoom = kMaxZoom;
  std::uint64_t map_pixels = defaults::kMapPixels;  // of a picture of a window
  /// Tiles that one address may have drawn, as RateLimit takes them; 0: as many as it likes.
  double drawn_per_second = 0;
  double drawn_burst = 1;
  /// What one tile may cost at most, as drawing_cost() counts; 0: whatever it does.
  std::uint64_t tile_cost = defaults::kTileCost;
  /// What the dear tiles and the documents of one address may cost, as RateLimit takes it; 0:
  /// whatever they do.
  double cost_per_second = 0;
  double cost_burst = 1;
  /// What /metrics answers; empty: it is not there.
  std::function<std::string()> metrics = {};
  /// What /ready tells of layers while they are read; empty: nothing.
  std::function<std::vector<LayerProgress>()> loading = {};
  /// Whether the server is about to end, and so not ready any more; empty: never.
  std::function<bool()> is_stopping = {};
  ViewerConfig viewer = {};
  /// What is said at "/" where `files` have no page.
  std::string why_no_viewer = "There is no viewer here.";
  /// What tiles there are.
  std::shared_ptr<const TileMatrixSets> sets =
      std::make_shared<const TileMatrixSets>(TileMatrixSets::built_in());
  /// What legends are written in.
  std::shared_ptr<const Fonts> fonts = std::make_shared<const Fonts>();
  /// Styles by name, and the memory in bytes for those that are posted.
  std::map<std::string, StyleQuery> styles = {};
  std::vector<std::string> label_fonts = {};  // that styles may name
  std::size_t posted_styles = StyleBook::kDefaultBudget;
  /// Rows of a table that is posted, and the memory in bytes for all of them.
  std::size_t values_rows = defaults::kValuesRows;
  std::size_t posted_values = std::size_t{defaults::kPostedValuesMegabytes} << 20;
};

class Site {
 public:
  /// `data`, `tiles` and `cache` outlive the site, and `cache` also `tiles`.
  Site(SiteOptions options, StaticFiles files, const CurrentDataset& data, TileService& tiles,
       TileCache& cache);

  /// Calls `respond` exactly once: within this call, or later from a worker.
  void handle(const HttpRequest& request, Respond respond) const;

 private:
  /// What makes documents, and perhaps finds that a picture of the map is asked for.
  struct Documents {
    Result<Document> (*make)(const DocumentRequest& request);
    std::optional<Result<PictureRequest>> (*find_picture)(const DocumentRequest& request) = nullptr;
    bool may_be_kept = true;  // while the data is the same
  };

  void dispatch(const Target& target, const HttpRequest& request, const Respond& respond) const;
  static HttpResponse answer_health();
  HttpResponse answer_ready() const;
  Result<std::string> catalog(const HttpRequest& request) const;
  Result<std::string> tile_json_of(const TileJsonRequest& tiles, const HttpRequest& request) const;
  Result<std::string> style_json(std::string_view path) const;
  /// Both are compressed for whoever takes that: by the worker of documents, as it takes time.
  void send_json(const HttpRequest& request, Result<std::string> json,
                 const Respond& respond) const;
  void send_document(const HttpRequest& request, const std::shared_ptr<const Document>& made,
                     const Respond& respond) const;
  HttpResponse answer_file(const Target& target, const HttpRequest& request) const;
  HttpResponse answer_posted_style(const HttpRequest& request) const;
  void handle_posted_values(const Target& target, const HttpRequest& request,
                            const Respond& respond) const;
  void handle_tiles(const Target& target, const HttpRequest& request, const Respond& respond) const;
  void handle_document(const Documents& documents, const Target& target, const HttpRequest& request,
                       const Respond& respond) const;
  bool answer_known(const HttpRequest& request, const Respond& respond) const;
  std::optional<HttpResponse> find_held(const HttpRequest& request, const KnownTarget& tile) const;
  void handle_picture(PictureRequest asked, const HttpRequest& request,
                      const Respond& respond) const;
  void handle_window(const WindowRequest& window, const HttpRequest& request,
                     const Respond& respond) const;
  /// The same once everything is known about the layers that the style asks for.
  void draw_window(const WindowRequest& window, std::shared_ptr<const Dataset> dataset,
                   const HttpRequest& request, const Respond& respond) const;
  HttpResponse answer_metrics() const;
  /// The response to a client that has asked for too much lately; null if it has not. Counts what
  /// it asks for now.
  std::optional<HttpResponse> find_impatience(const HttpRequest& request, std::uint64_t cost) const;
  /// What of a picture is beyond the limits of this site.
  std::optional<Problem> find_excess(const TileRequest& tile) const;
  std::optional<Problem> find_excess(const WindowRequest& window) const;
  std::optional<Problem> find_excess(std::span<const std::string> layers) const;
  /// How the client reached this server, as the beginning of a URL; nothing if it does not say, or
  /// says nonsense.
  Result<std::string> base_url(const HttpRequest& request) const;

  const SiteOptions options_;
  const StaticFiles files_;
  const std::unique_ptr<RateLimit> draw_limit_;
  const std::unique_ptr<RateLimit> cost_limit_;
  const std::unique_ptr<RateLimit> post_limit_;    // in bytes of styles
  const std::unique_ptr<RateLimit> values_limit_;  // in bytes of tables
  const CurrentDataset& data_;
  TileService& tiles_;
  TileCache& cache_;
  const std::unique_ptr<KnownTargets> known_targets_;
  const std::shared_ptr<KnownFingerprints> known_fingerprints_;  // with answers that come late
  const std::shared_ptr<ValueBook> values_;
  const std::unique_ptr<StyleBook> styles_;
  const std::unique_ptr<DocumentWorker> documents_;  // last, as it uses the others
};

}  // namespace trapeze
