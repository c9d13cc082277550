// Answers every URL: requests in, responses out, without a socket.
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
  /// The URL of this server in documents, without a final '/'; empty: taken from the Host header of
  /// each request.
  std::string public_url = {};
  /// The Host headers accepted for that, in the format of is_allowed_host(); empty: all.
  std::vector<std::string> allowed_hosts = {};
  /// The Cache-Control header of tiles, for caches between server and client.
  std::string cache_control{defaults::kCacheControl};
  std::size_t max_layers = kMaxLayersPerTile;  // of one tile
  int max_scale = kMaxScale;
  int max_zoom = kMaxZoom;
  std::uint64_t map_pixels = defaults::kMapPixels;  // of the picture of a window
  /// How many tiles one address may have drawn, see RateLimit; 0: no limit.
  double drawn_per_second = 0;
  double drawn_burst = 1;
  /// Maximum cost of one tile, as computed by drawing_cost(); 0: no limit.
  std::uint64_t tile_cost = defaults::kTileCost;
  /// Limit for the cost of the expensive tiles and the documents that one address requests, see
  /// RateLimit; 0: no limit.
  double cost_per_second = 0;
  double cost_burst = 1;
  /// The response body of /metrics; empty: /metrics does not exist.
  std::function<std::string()> metrics = {};
  /// The progress of layers for /ready while they are read; empty: not reported.
  std::function<std::vector<LayerProgress>()> loading = {};
  /// Whether the server is about to stop and therefore no longer ready; empty: never.
  std::function<bool()> is_stopping = {};
  ViewerConfig viewer = {};
  /// The text at "/" if `files` contain no page.
  std::string why_no_viewer = "There is no viewer here.";
  /// The available tile matrix sets.
  std::shared_ptr<const TileMatrixSets> sets =
      std::make_shared<const TileMatrixSets>(TileMatrixSets::built_in());
  /// Fonts for legends.
  std::shared_ptr<const Fonts> fonts = std::make_shared<const Fonts>();
  /// Named styles, and the memory in bytes for posted ones.
  std::map<std::string, StyleQuery> styles = {};
  std::vector<std::string> label_fonts = {};  // that styles may name
  std::size_t posted_styles = StyleBook::kDefaultBudget;
  /// Maximum rows of a posted table, and the memory in bytes for all posted tables.
  std::size_t values_rows = defaults::kValuesRows;
  std::size_t posted_values = std::size_t{defaults::kPostedValuesMegabytes} << 20;
};

class Site {
 public:
  /// `data`, `tiles` and `cache` must outlive the site, and `cache` must outlive `tiles`.
  Site(SiteOptions options, StaticFiles files, const CurrentDataset& data, TileService& tiles,
       TileCache& cache);

  /// Calls `respond` exactly once: within this call, or later from a worker.
  void handle(const HttpRequest& request, Respond respond) const;

 private:
  /// Creates documents. `find_picture`, if set, detects requests for a picture of the map.
  struct Documents {
    Result<Document> (*make)(const DocumentRequest& request);
    std::optional<Result<PictureRequest>> (*find_picture)(const DocumentRequest& request) = nullptr;
    bool may_be_kept = true;  // cacheable while the data is the same
  };

  void dispatch(const Target& target, const HttpRequest& request, const Respond& respond) const;
  static HttpResponse answer_health();
  HttpResponse answer_ready() const;
  Result<std::string> catalog(const HttpRequest& request) const;
  Result<std::string> tile_json_of(const TileJsonRequest& tiles, const HttpRequest& request) const;
  Result<std::string> style_json(std::string_view path) const;
  /// Both compress if the client accepts it. The document worker does that, as it takes time.
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
  /// The same once everything is known about the layers that the style needs.
  void draw_window(const WindowRequest& window, std::shared_ptr<const Dataset> dataset,
                   const HttpRequest& request, const Respond& respond) const;
  HttpResponse answer_metrics() const;
  /// The response to a client that has exceeded its limit; null otherwise. Charges the client for
  /// this request.
  std::optional<HttpResponse> find_impatience(const HttpRequest& request, std::uint64_t cost) const;
  /// What in a request for a picture exceeds the limits of this site.
  std::optional<Problem> find_excess(const TileRequest& tile) const;
  std::optional<Problem> find_excess(const WindowRequest& window) const;
  std::optional<Problem> find_excess(std::span<const std::string> layers) const;
  /// The beginning of the URL by which the client reached this server; a problem if the client does
  /// not state it or it is invalid.
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
  const std::shared_ptr<KnownFingerprints> known_fingerprints_;  // shared with late answers
  const std::shared_ptr<ValueBook> values_;
  const std::unique_ptr<StyleBook> styles_;
  const std::unique_ptr<DocumentWorker> documents_;  // last, as it uses the other members
};

}  // namespace trapeze
