#include "server/service/site.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <utility>

#include "render/picture/webp.h"
#include "server/base/content_hash.h"
#include "server/base/json_text.h"
#include "server/base/url.h"
#include "server/documents/attribute_values.h"
#include "server/documents/catalog.h"
#include "server/documents/document.h"
#include "server/documents/identify.h"
#include "server/documents/legend.h"
#include "server/documents/map_picture.h"
#include "server/documents/ogc_api.h"
#include "server/documents/ows_exception.h"
#include "server/documents/routes.h"
#include "server/documents/value_tables.h"
#include "server/documents/wms.h"
#include "server/documents/wms_exception.h"
#include "server/documents/wmts.h"
#include "server/documents/wmts_request.h"
#include "server/http/content_encoding.h"
#include "server/service/metrics.h"
#include "server/styles/style_document.h"
#include "server/tiles/drawing_cost.h"
#include "server/tiles/map_window.h"
#include "server/tiles/paint_stages.h"
#include "server/tiles/tile_matrix_set.h"

namespace trapeze {

namespace {

constexpr std::size_t kKnownTargetBytes = std::size_t{8} << 20;
constexpr std::size_t kKnownFingerprintBytes = std::size_t{16} << 20;

// Documents and the viewer may change with every start: clients revalidate, and usually get 304.
constexpr std::string_view kDocumentCaching = "no-cache";

constexpr std::uint64_t kDocumentCost = 500'000;  // in units of drawing_cost(): 20 ms
// In the same units. After such a picture, a worker frees its memory: about 100 MB.
constexpr std::uint64_t kGiantTile = 4'000'000;
constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint64_t kMostToldPixels = 1 << 21;  // of a picture with an error message
constexpr int kClientGone = 499;                    // as nginx logs it; no client reads it

// An address may post an eighth of the memory for styles, and as much again each hour, so that
// others keep theirs.
constexpr double kShareSeconds = 3600;

double share_of_styles(const SiteOptions& options) {
  return static_cast<double>(options.posted_styles) / 8;
}

// Tables are larger and made by hand: an address may post half of the memory for tables, and as
// much again every ten minutes.
constexpr double kTablesSeconds = 600;

double share_of_tables(const SiteOptions& options) {
  return std::max(static_cast<double>(options.posted_values) / 2, 1.0);
}

/// How long the client has to wait until it gets so many tokens of a limit for one address. Trusted
/// proxies do not wait.
std::optional<std::chrono::duration<double>> pause_of(const HttpRequest& request, RateLimit& limit,
                                                      double tokens) {
  if (request.is_of_proxy) return std::nullopt;
  return limit.take(limited_address(request.client), RateLimit::Clock::now(), tokens);
}

Problem too_large_style(std::size_t length, const SiteOptions& options) {
  return {403, fmt::format("This style has {} bytes, written as a query: more than one address may "
                           "post here. An eighth of the {} MB for styles is for each.",
                           length, options.posted_styles >> 20)};
}

Problem too_dear(std::uint64_t most) {
  return {400, fmt::format("This picture would take more than {} units of drawing, the limit here. "
                           "Use a coarser simplify, a smaller scale, fewer layers or no outlines.",
                           most)};
}

Problem still_loading() {
  return {503, "The data is still being loaded."};
}

/// The layers being read, with their progress.
Json loading_json(const SiteOptions& site) {
  Json layers = Json::array();
  for (const LayerProgress& layer : site.loading ? site.loading() : std::vector<LayerProgress>()) {
    layers.push_back({{"name", layer.name},
                      {"title", layer.title},
                      {"percent", layer.percent ? Json(*layer.percent) : Json(nullptr)}});
  }
  return {{"status", "loading"}, {"detail", still_loading().detail}, {"layers", std::move(layers)}};
}

/// For /ready, which reports the state of the server and not a problem with a request.
HttpResponse not_ready(const Json& state) {
  HttpResponse response;
  response.status = 503;
  response.headers = {
      {"Content-Type", "application/json"}, {"Cache-Control", "no-store"}, {"Retry-After", "1"}};
  response.body = std::make_shared<const std::string>(to_text(state));
  return response;
}

HttpResponse answer_options(std::string_view path) {
  const std::string methods = methods_of(path);
  HttpResponse response;
  response.status = 204;
  response.headers = {{"Allow", methods},
                      {"Access-Control-Allow-Methods", methods},
                      {"Access-Control-Allow-Headers", "*"},
                      {"Access-Control-Max-Age", "86400"}};
  return response;
}

HttpResponse refuse_method(const std::string& method, std::string_view path) {
  const std::string methods = methods_of(path);
  auto response = problem_response(
      {405, fmt::format("Only {} are understood here.", methods), "method", method, methods});
  response.headers.emplace_back("Allow", methods);
  return response;
}

/// What is known about a document before it is sent.
struct DocumentHead {
  std::string_view content_type;
  std::string entity_tag;
  ContentEncoding encoding = ContentEncoding::identity;
  bool varies = false;  // other clients may get another encoding
};

/// 200 with the document, or 304 if the client already has it.
HttpResponse document(const HttpRequest& request, const DocumentHead& head,
                      std::shared_ptr<const std::string> body) {
  HttpResponse response;
  response.headers = {{"ETag", head.entity_tag}, {"Cache-Control", std::string(kDocumentCaching)}};
  if (head.varies) response.headers.emplace_back("Vary", "Accept-Encoding");
  if (matches_entity_tag(request.if_none_match, head.entity_tag)) {
    response.status = 304;
    return response;
  }
  response.headers.emplace_back("Content-Type", std::string(head.content_type));
  if (head.encoding != ContentEncoding::identity) {
    response.headers.emplace_back("Content-Encoding", std::string(name_of(head.encoding)));
  }
  response.body = std::move(body);
  return response;
}

std::shared_ptr<const std::string> bytes_of(const std::shared_ptr<const Document>& document) {
  return {document, &document->bytes};
}

DocumentHead head_of(const Document& made) {
  ContentHash hash;
  hash.add(made.content_type);
  hash.add(made.bytes);
  DocumentHead head;
  head.content_type = made.content_type;
  head.entity_tag = fmt::format("\"{}\"", hash.hex());
  head.varies = made.bytes.size() >= kLeastToCompress && is_worth_compressing(made.content_type);
  return head;
}

std::string server_timing(const PaintTimes& times) {
  std::string text;
  for (const PaintStage& stage : kPaintStages) {
    fmt::format_to(std::back_inserter(text), "{}{};dur={:.3f}", text.empty() ? "" : ", ",
                   stage.name, times.*stage.milliseconds);
  }
  return text;
}

/// A strong tag: tiles with the same fingerprint have the same bytes.
std::string entity_tag_of(const std::string& fingerprint) {
  return fmt::format("\"{}\"", fingerprint);
}

/// Response settings of tiles that do not depend on their contents.
struct TileHead {
  TileFormat format = TileFormat::png;
  std::string cache_control;
};

HttpResponse tile_headers(int status, const std::string& fingerprint, const TileHead& head) {
  HttpResponse response;
  response.status = status;
  response.headers = {{"ETag", entity_tag_of(fingerprint)}, {"Cache-Control", head.cache_control}};
  return response;
}

HttpResponse tile_response(const TileCache::Tile& tile, const std::string& fingerprint,
                           const TileHead& head, std::string_view from) {
  auto response = tile_headers(200, fingerprint, head);
  response.headers.emplace_back("Content-Type", content_type_of(head.format));
  response.headers.emplace_back("X-Cache", from);
  if (tile.hint != TileHint::none) {
    response.headers.emplace_back("OATiles-hint", tile.hint == TileHint::empty ? "empty" : "full");
  }
  response.body = tile.bytes;
  return response;
}

/// For a tile whose fingerprint is known.
HttpResponse answered_response(const TileAnswer& answer, const std::string& if_none_match,
                               const TileHead& head) {
  const PaintedTile& tile = answer.tile;
  const bool is_drawn = answer.outcome == TileOutcome::drawn;
  const bool is_held = matches_entity_tag(if_none_match, entity_tag_of(tile.fingerprint));
  HttpResponse response = is_held ? tile_headers(304, tile.fingerprint, head)
                                  : tile_response({tile.bytes, tile.hint}, tile.fingerprint, head,
                                                  is_drawn ? "MISS" : "HIT");
  response.headers.emplace_back("Server-Timing", server_timing(tile.times));
  return response;
}

/// The problem in the format that WMTS clients expect. Requests with key-value pairs never get "not
/// found": their address is always the same.
HttpResponse in_words_of_wmts(HttpResponse response, std::string_view target) {
  if (response.problem == nullptr) return response;
  const auto split = split_target(target);
  const std::string_view path = split ? split->path : std::string_view();
  if (response.status == 404 && is_wmts_key_value_path(path)) response.status = 400;
  for (auto& [name, value] : response.headers) {
    if (name == "Content-Type") value = "application/xml";
  }
  response.body = std::make_shared<const std::string>(exception_report(*response.problem));
  return response;
}

/// The problem in the format that the WMS client requests. Clients show a picture with an error
/// message only if its status is 200.
HttpResponse in_words_of_wms(HttpResponse response, std::string_view target, const Fonts& fonts,
                             std::uint64_t most_pixels) {
  if (response.problem == nullptr) return response;
  const auto split = split_target(target);
  const auto query = decode_query(split ? split->query : std::string_view());
  Document told = wms_exception(*response.problem, query.value_or(std::vector<QueryPair>()), fonts,
                                std::min(most_pixels, kMostToldPixels));
  if (response.status == 404) response.status = 400;  // the address is always the same
  if (told.content_type.starts_with("image/")) response.status = 200;
  for (auto& [name, value] : response.headers) {
    if (name == "Content-Type") value = told.content_type;
  }
  response.body = std::make_shared<const std::string>(std::move(told.bytes));
  return response;
}

HttpResponse undrawn_response(TileOutcome outcome) {
  switch (outcome) {
    case TileOutcome::saturated:
      return problem_response(
          {503, "The server has more tiles to draw than it can handle. Try again."});
    case TileOutcome::withdrawn:
      return problem_response({kClientGone, "The client has gone."});
    case TileOutcome::late:
      return problem_response({504, "The tile was not drawn in time."});
    case TileOutcome::placing:
      return problem_response({503, "The labels of this map are being placed. Try again."});
    case TileOutcome::damaged:
      return problem_response(
          {503,
           "A file of a requested layer was truncated or modified. It has to be prepared again."});
    default:
      return problem_response({500, "The tile could not be drawn."});
  }
}

/// Everything below /map is a picture.
std::optional<Result<PictureRequest>> find_map_picture(const DocumentRequest& request) {
  auto window = parse_map_picture(request);
  if (!window) return Result<PictureRequest>(std::move(window).problem());
  return Result<PictureRequest>(*std::move(window));
}

/// The bounds of a picture: the minimum of both axes, then the maximum, in the axis order of the
/// reference system.
std::string bounds_text(const WindowRequest& window) {
  const MapSystem& system = *window.system;
  const auto [west, south, east, north] = system.bounds_of(window.view);
  const int digits = system.is_in_degrees ? 8 : 3;
  return system.is_north_first ? fmt::format("{0:.{4}f},{1:.{4}f},{2:.{4}f},{3:.{4}f}", south, west,
                                             north, east, digits)
                               : fmt::format("{0:.{4}f},{1:.{4}f},{2:.{4}f},{3:.{4}f}", west, south,
                                             east, north, digits);
}

std::uint64_t pixels_of(const View& view) {
  return static_cast<std::uint64_t>(view.width) * static_cast<std::uint64_t>(view.height);
}

std::vector<std::size_t> layers_of(const TilePlan& plan) {
  std::vector<std::size_t> layers;
  for (const LayerPaint& paint : plan.layers) layers.push_back(paint.layer);
  return layers;
}

}  // namespace

Site::Site(SiteOptions options, StaticFiles files, const CurrentDataset& data, TileService& tiles,
           TileCache& cache)
    : options_(std::move(options)),
      files_(std::move(files)),
      draw_limit_(std::make_unique<RateLimit>(options_.drawn_per_second, options_.drawn_burst)),
      cost_limit_(std::make_unique<RateLimit>(options_.cost_per_second, options_.cost_burst)),
      post_limit_(std::make_unique<RateLimit>(share_of_styles(options_) / kShareSeconds,
                                              share_of_styles(options_))),
      values_limit_(std::make_unique<RateLimit>(share_of_tables(options_) / kTablesSeconds,
                                                share_of_tables(options_))),
      data_(data),
      tiles_(tiles),
      cache_(cache),
      known_targets_(std::make_unique<KnownTargets>(kKnownTargetBytes)),
      known_fingerprints_(std::make_shared<KnownFingerprints>(kKnownFingerprintBytes)),
      values_(std::make_shared<ValueBook>(options_.posted_values)),
      styles_(std::make_unique<StyleBook>(options_.styles, options_.posted_styles, values_,
                                          options_.label_fonts)),
      documents_(std::make_unique<DocumentWorker>()) {}

void Site::handle(const HttpRequest& request, Respond respond) const {
  const auto target = split_target(request.target);
  const std::string_view path = target ? target->path : std::string_view();
  const Area area = area_of(path);
  const bool has_own_words = area == Area::wmts || area == Area::wms;
  // The last answers may come while the service shuts down, after this site is gone.
  const auto respond_to_all =
      [respond = std::move(respond), area, fonts = options_.fonts, most = options_.map_pixels,
       target = has_own_words ? request.target : std::string()](HttpResponse response) {
        if (area == Area::wmts) response = in_words_of_wmts(std::move(response), target);
        if (area == Area::wms)
          response = in_words_of_wms(std::move(response), target, *fonts, most);
        allow_every_origin(response);
        respond(std::move(response));
      };
  if (request.method == "OPTIONS") return respond_to_all(answer_options(path));
  if (!understands(path, request.method)) {
    return respond_to_all(refuse_method(request.method, path));
  }
  if (!target) return respond_to_all(problem_response(malformed_target()));
  dispatch(*target, request, respond_to_all);
}

void Site::dispatch(const Target& target, const HttpRequest& request,
                    const Respond& respond) const {
  const Area area = area_of(target.path);
  const bool is_all = target.path.size() == 1 + name_of(area).size();  // nothing follows the name
  switch (area) {
    case Area::tiles:
      return handle_tiles(target, request, respond);
    case Area::legend:
      return handle_document({legend_document}, target, request, respond);
    case Area::identify:
      return handle_document({identify_document}, target, request, respond);
    case Area::values:
      if (request.method == "POST") return handle_posted_values(target, request, respond);
      if (is_all || target.path.find('/', 1) == target.path.rfind('/')) {
        return handle_document({value_tables_document, nullptr, false}, target, request, respond);
      }
      return handle_document({values_document}, target, request, respond);
    case Area::ogc:
      return handle_document({ogc_document, parse_ogc_picture}, target, request, respond);
    case Area::map:
      return handle_document({nullptr, find_map_picture}, target, request, respond);
    case Area::wms:
      return handle_document({wms_document, parse_wms_map}, target, request, respond);
    case Area::wmts:
      return handle_document({wmts_document, parse_wmts_tile}, target, request, respond);
    case Area::styles:
      if (request.method == "POST") return respond(answer_posted_style(request));
      return send_json(request, style_json(target.path), respond);
    case Area::catalog:
      if (is_all) return send_json(request, catalog(request), respond);
      break;
    case Area::health:
      if (is_all) return respond(answer_health());
      break;
    case Area::ready:
      if (is_all) return respond(answer_ready());
      break;
    case Area::metrics:
      if (is_all && options_.metrics) return respond(answer_metrics());
      break;
    case Area::other:
      break;
  }
  respond(answer_file(target, request));
}

HttpResponse Site::answer_health() {
  HttpResponse response;
  response.headers = {{"Content-Type", "application/json"}, {"Cache-Control", "no-store"}};
  response.body = std::make_shared<const std::string>("{\"status\": \"ok\"}\n");
  return response;
}

HttpResponse Site::answer_ready() const {
  if (data_.get() == nullptr) return not_ready(loading_json(options_));
  if (options_.is_stopping && options_.is_stopping()) {
    return not_ready({{"status", "stopping"}, {"detail", "The server is about to end."}});
  }
  HttpResponse response;
  response.headers = {{"Content-Type", "application/json"}, {"Cache-Control", "no-store"}};
  response.body = std::make_shared<const std::string>("{\"status\": \"ready\"}\n");
  return response;
}

HttpResponse Site::answer_metrics() const {
  HttpResponse response;
  response.headers = {{"Content-Type", std::string(Metrics::kContentType)},
                      {"Cache-Control", "no-store"}};
  response.body = std::make_shared<const std::string>(options_.metrics());
  return response;
}

Result<std::string> Site::catalog(const HttpRequest& request) const {
  const auto dataset = data_.get();
  if (dataset == nullptr) return still_loading();
  const auto base = base_url(request);
  if (!base) return base.problem();
  return catalog_json(*dataset, tiles_.renderer_name(), options_.viewer, *base);
}

Result<std::string> Site::tile_json_of(const TileJsonRequest& tiles,
                                       const HttpRequest& request) const {
  const auto dataset = data_.get();
  if (dataset == nullptr) return still_loading();
  const auto base = base_url(request);
  if (!base) return base.problem();
  return tile_json(tiles, *dataset, *base);
}

// All names, or one style.
Result<std::string> Site::style_json(std::string_view path) const {
  const std::string_view name = path.substr(name_of(Area::styles).size() + 1);
  if (name.empty()) return to_text({{"styles", styles_->names()}});
  const auto style = styles_->find(name.substr(1));
  if (style == nullptr) return Problem{404, "There is no style of that name."};
  return style_document(*style);
}

void Site::send_json(const HttpRequest& request, Result<std::string> json,
                     const Respond& respond) const {
  if (!json) return respond(problem_response(json.problem()));
  send_document(request,
                std::make_shared<const Document>(Document{"application/json", *std::move(json)}),
                respond);
}

// Compressed documents are cached by the tag of their contents, regardless of the address. If the
// worker is overloaded, the text is sent uncompressed.
void Site::send_document(const HttpRequest& request, const std::shared_ptr<const Document>& made,
                         const Respond& respond) const {
  const DocumentHead plain = head_of(*made);
  DocumentHead head = plain;
  if (plain.varies) head.encoding = best_encoding(request.accept_encoding);
  head.entity_tag = encoded_tag(plain.entity_tag, head.encoding);
  if (head.encoding == ContentEncoding::identity ||
      matches_entity_tag(request.if_none_match, head.entity_tag)) {
    return respond(document(request, head, bytes_of(made)));
  }
  const auto dataset = data_.get();
  if (const auto kept = documents_->find(dataset, head.entity_tag)) {
    return respond(document(request, head, bytes_of(kept)));
  }
  documents_->submit(
      dataset, head.entity_tag,
      [made, encoding = head.encoding]() -> Result<Document> {
        auto compressed = compress(made->bytes, encoding, Effort::quick);
        if (!compressed) return Problem{500, "The document does not become smaller."};
        return Document{made->content_type, *std::move(compressed)};
      },
      // The content types that the heads refer to belong to `made`.
      [request, respond, made, plain, head](const DocumentWorker::Answer& compressed) {
        respond(compressed ? document(request, head, bytes_of(*compressed))
                           : document(request, plain, bytes_of(made)));
      });
}

HttpResponse Site::answer_posted_style(const HttpRequest& request) const {
  const auto base = base_url(request);
  if (!base) return problem_response(base.problem());
  auto style = parse_style_document(request.body);
  if (!style) return problem_response(style.problem());
  const std::string query = style->canonical_text();
  if (styles_->find(StyleBook::id_of(*style)) == nullptr) {
    const auto memory = static_cast<double>(StyleBook::memory_of(*style));
    if (options_.posted_styles > 0 && memory > share_of_styles(options_)) {
      return problem_response(too_large_style(query.size(), options_));
    }
    if (const auto pause = pause_of(request, *post_limit_, memory)) {
      return problem_response({429, "One address cannot post so many styles. Try again."}, *pause);
    }
  }
  const auto id = styles_->post(*std::move(style));
  if (!id) return problem_response(id.problem());
  const std::string& name = *id;
  const std::string& root = *base;
  HttpResponse response;
  response.status = 201;
  response.headers = {{"Location", fmt::format("{}/styles/{}", root, name)},
                      {"Content-Type", "application/json"},
                      {"Cache-Control", "no-store"}};
  response.body = std::make_shared<const std::string>(to_text(
      {{"id", name},
       {"query", query},
       {"tiles", fmt::format("{}/tiles/{{layers}}/s/{}/{{z}}/{{x}}/{{y}}.png", root, name)}}));
  return response;
}

// Reading a table takes milliseconds, so the document worker does it.
void Site::handle_posted_values(const Target& target, const HttpRequest& request,
                                const Respond& respond) const {
  const auto refuse = [&respond](const Problem& problem) { respond(problem_response(problem)); };
  if (options_.posted_values == 0) {
    return refuse({403, "This server does not keep posted tables."});
  }
  const auto pairs = decode_query(target.query);
  if (!pairs) return refuse(malformed_target());
  const auto query = parse_table_query(*pairs);
  if (!query) return refuse(query.problem());
  auto base = base_url(request);
  if (!base) return refuse(base.problem());
  const auto dataset = data_.get();
  if (dataset == nullptr) return refuse(still_loading());
  if (!request.content_encoding.empty() && request.content_encoding != "identity") {
    return refuse({415, "A table is sent as it is, and not compressed.", "Content-Encoding",
                   request.content_encoding, "no such header"});
  }
  const auto format = table_format(request.content_type, request.body);
  if (!format) return refuse(format.problem());
  // However short it is, the table is joined to whole layers.
  if (auto refusal = find_impatience(request, kDocumentCost)) return respond(*std::move(refusal));
  const auto bytes = static_cast<double>(request.body.size());
  if (const auto pause = pause_of(request, *values_limit_, bytes)) {
    return respond(
        problem_response({429, "One address cannot post so many tables. Try again."}, *pause));
  }
  const ReadValuesOptions options{query->columns, options_.values_rows};
  auto id = std::make_shared<std::string>();
  const auto make = [body = std::make_shared<const std::string>(request.body), format = *format,
                     options, query = *query, dataset, base = *base, values = values_,
                     id]() -> Result<Document> {
    auto read = read_values(*body, format, options);
    if (!read) return std::move(read).problem();
    const auto table = values->post(*std::move(read));
    if (!table) return table.problem();
    *id = (*table)->id();
    return table_document(*id, *table, query, *dataset, base);
  };
  documents_->submit(dataset, {}, make,
                     [respond, id, base = *base](const DocumentWorker::Answer& made) {
                       if (!made) return respond(problem_response(made.problem()));
                       HttpResponse response;
                       response.status = 201;
                       response.headers = {{"Location", fmt::format("{}/values/{}", base, *id)},
                                           {"Content-Type", "application/json"},
                                           {"Cache-Control", "no-store"}};
                       response.body = bytes_of(*made);
                       respond(std::move(response));
                     });
}

HttpResponse Site::answer_file(const Target& target, const HttpRequest& request) const {
  const auto path = percent_decode(target.path, Plus::literal);
  if (!path) return problem_response(malformed_target());
  const StaticFile* file = files_.find(*path);
  if (file == nullptr) {
    return problem_response({404, *path == "/"
                                      ? options_.why_no_viewer + " The layers are at /catalog."
                                      : "There is nothing here. The layers are at /catalog."});
  }
  const auto encodings = file->encodings();
  DocumentHead head;
  head.content_type = file->content_type;
  head.encoding = best_encoding(request.accept_encoding, encodings);
  head.entity_tag = encoded_tag(file->entity_tag, head.encoding);
  head.varies = !encodings.empty();
  return document(request, head, file->in(head.encoding));
}

void Site::handle_tiles(const Target& target, const HttpRequest& request,
                        const Respond& respond) const {
  if (answer_known(request, respond)) return;
  auto parsed = parse_tiles_target(target, *styles_, *options_.sets);
  if (!parsed) return respond(problem_response(parsed.problem()));
  auto& tiles = *parsed;
  if (const auto* tile_json = std::get_if<TileJsonRequest>(&tiles)) {
    return send_json(request, tile_json_of(*tile_json, request), respond);
  }
  handle_picture(std::get<TileRequest>(std::move(tiles)), request, respond);
}

/// False if the target is not known, or the tile has to be drawn.
bool Site::answer_known(const HttpRequest& request, const Respond& respond) const {
  const auto dataset = data_.get();
  if (dataset == nullptr) return false;
  const auto known = known_targets_->find(dataset, request.target);
  if (known == nullptr) return false;
  const bool is_whole = std::ranges::all_of(known->layers, [&](std::size_t layer) {
    return dataset->layers_on_all_grids()[layer].was_whole_lately();
  });
  if (!is_whole) return false;
  auto held = find_held(request, *known);
  if (!held) return false;
  respond(*std::move(held));
  return true;
}

/// The answer if the tile need not be drawn: 304 if the client has it, or the tile from the cache.
std::optional<HttpResponse> Site::find_held(const HttpRequest& request,
                                            const KnownTarget& tile) const {
  const TileHead head{tile.format, options_.cache_control};
  if (matches_entity_tag(request.if_none_match, entity_tag_of(tile.fingerprint))) {
    return tile_headers(304, tile.fingerprint, head);
  }
  const auto kept = cache_.find(tile.fingerprint);
  if (kept.bytes == nullptr) return std::nullopt;
  return tile_response(kept, tile.fingerprint, head, "HIT");
}

void Site::handle_document(const Documents& documents, const Target& target,
                           const HttpRequest& request, const Respond& respond) const {
  auto path = decode_path(target.path);
  auto query = decode_query(target.query);
  if (!path || !query) return respond(problem_response(malformed_target()));
  const auto dataset = data_.get();
  if (dataset == nullptr) return respond(problem_response(still_loading()));
  auto base = base_url(request);
  if (!base) return respond(problem_response(base.problem()));
  std::string key =
      documents.may_be_kept ? fmt::format("{} {}", *base, request.target) : std::string();
  const DocumentRequest asked{*dataset,
                              *styles_,
                              *options_.fonts,
                              *std::move(base),
                              std::move(*path),
                              *std::move(query),
                              options_.map_pixels,
                              *options_.sets,
                              options_.max_layers,
                              options_.max_zoom};
  if (auto picture = documents.find_picture ? documents.find_picture(asked) : std::nullopt) {
    Result<PictureRequest>& found = *picture;
    return found ? handle_picture(*std::move(found), request, respond)
                 : respond(problem_response(found.problem()));
  }
  if (const auto kept = documents_->find(dataset, key)) {
    return send_document(request, kept, respond);
  }
  if (auto refusal = find_impatience(request, kDocumentCost)) return respond(*std::move(refusal));
  documents_->submit(
      dataset, std::move(key), [asked, make = documents.make] { return make(asked); },
      [this, request, respond](const DocumentWorker::Answer& made) {
        if (!made) return respond(problem_response(made.problem()));
        send_document(request, *made, respond);
      });
}

std::optional<HttpResponse> Site::find_impatience(const HttpRequest& request,
                                                  std::uint64_t cost) const {
  if (const auto pause = pause_of(request, *draw_limit_, 1)) {
    return problem_response(
        {429, "One address cannot request so many new tiles at once. Try again."}, *pause);
  }
  if (cost <= defaults::kOrdinaryTile) return std::nullopt;
  if (const auto pause = pause_of(request, *cost_limit_, static_cast<double>(cost))) {
    return problem_response({429, "One address cannot request so many expensive tiles. Try again."},
                            *pause);
  }
  return std::nullopt;
}

std::optional<Problem> Site::find_excess(const TileRequest& tile) const {
  if (tile.zoom() > options_.max_zoom) {
    Problem problem{404, fmt::format("There is no such tile: zoom is 0 to {}, column and row are 0 "
                                     "to 2^zoom - 1.",
                                     options_.max_zoom)};
    if (tile.set != web_mercator_quad()) {
      problem.detail = fmt::format(
          "There is no such tile here: its pixels are smaller than those "
          "of zoom {} of Web Mercator.",
          options_.max_zoom);
    }
    problem.code = ows::kTileOutOfRange;
    return problem;
  }
  if (tile.scale > options_.max_scale) {
    return Problem{400, fmt::format("A tile's scale is @1x to @{}x.", options_.max_scale), "scale",
                   fmt::format("{}x", tile.scale), fmt::format("1x to {}x", options_.max_scale)};
  }
  const TileMatrix& matrix = tile.set->matrices[static_cast<std::size_t>(tile.tile.z)];
  const auto pixels = static_cast<std::uint64_t>(matrix.tile_width) *
                      static_cast<std::uint64_t>(matrix.tile_height) *
                      static_cast<std::uint64_t>(tile.scale * tile.scale);
  if (tile.set != web_mercator_quad() && pixels > options_.map_pixels) {
    return Problem{400, fmt::format("A picture can have at most {} pixels.", options_.map_pixels),
                   "scale", fmt::format("{}x", tile.scale), "a smaller scale"};
  }
  return find_excess(tile.layers);
}

std::optional<Problem> Site::find_excess(std::span<const std::string> layers) const {
  if (layers.size() <= options_.max_layers) return std::nullopt;
  return Problem{400, fmt::format("A tile shows at most {} layers.", options_.max_layers), "layers",
                 fmt::format("{} layers", layers.size()),
                 fmt::format("at most {} layers", options_.max_layers)};
}

std::optional<Problem> Site::find_excess(const WindowRequest& window) const {
  const View& view = window.view;
  const std::string size = fmt::format("{} x {}", view.width, view.height);
  if (pixels_of(view) > options_.map_pixels) {
    return Problem{400, fmt::format("A picture can have at most {} pixels.", options_.map_pixels),
                   "width", size,
                   fmt::format("width times height of at most {}", options_.map_pixels)};
  }
  if (window.format == TileFormat::webp && std::max(view.width, view.height) > kMaxWebpPixels) {
    return Problem{400, fmt::format("WebP is at most {} pixels wide and high.", kMaxWebpPixels),
                   "width", size, fmt::format("1 to {}", kMaxWebpPixels)};
  }
  const double zoom = window.system->zoom_of(view, window.scale);
  if (zoom > options_.max_zoom) {
    return Problem{400,
                   fmt::format("The pixels are smaller than those of zoom {}, which is the last.",
                               options_.max_zoom),
                   "bbox", fmt::format("zoom {:.2f}", zoom),
                   fmt::format("a window of zoom 0 to {}", options_.max_zoom)};
  }
  return find_excess(window.layers);
}

void Site::handle_picture(PictureRequest asked, const HttpRequest& request,
                          const Respond& respond) const {
  const auto excess =
      std::visit([this](const auto& picture) { return find_excess(picture); }, asked);
  if (excess) return respond(problem_response(*excess));
  if (auto* tile = std::get_if<TileRequest>(&asked)) {
    return handle_window(window_of(std::move(*tile)), request, respond);
  }
  const auto& window = std::get<WindowRequest>(asked);
  handle_window(
      window, request,
      [respond, bounds = bounds_text(window), system = window.system](HttpResponse answer) {
        if (answer.problem == nullptr) {
          answer.headers.emplace_back("Content-Bbox", bounds);
          answer.headers.emplace_back("Content-Crs", fmt::format("<{}>", system->uri));
        }
        respond(std::move(answer));
      });
}

void Site::handle_window(const WindowRequest& window, const HttpRequest& request,
                         const Respond& respond) const {
  auto dataset = data_.get();
  if (dataset == nullptr) return respond(problem_response(still_loading()));
  if (!has_to_look(window, *dataset)) {
    return draw_window(window, std::move(dataset), request, respond);
  }
  // Joins and classes for a whole layer take too long for the I/O threads.
  if (auto refusal = find_impatience(request, kDocumentCost)) return respond(*std::move(refusal));
  const auto look = [window, dataset]() -> Result<Document> {
    const auto planned = plan_window(window, dataset);
    if (!planned) return planned.problem();
    return Document{};
  };
  documents_->submit(
      dataset, {}, look,
      [this, window, dataset, request, respond](const DocumentWorker::Answer& looked) {
        if (!looked) return respond(problem_response(looked.problem()));
        draw_window(window, dataset, request, respond);
      });
}

void Site::draw_window(const WindowRequest& window, std::shared_ptr<const Dataset> dataset,
                       const HttpRequest& request, const Respond& respond) const {
  auto planned = plan_window(window, std::move(dataset));
  if (!planned) {
    return respond(problem_response(planned.problem()));
  }
  auto& plan = *planned;
  if (const ServedLayer* damaged = plan.damaged_layer()) {
    return respond(problem_response(damaged_layer(*damaged)));
  }
  TileService::Order order;
  order.key = plan.key();
  if (std::string fingerprint = known_fingerprints_->find(order.key); !fingerprint.empty()) {
    KnownTarget known{std::move(fingerprint), window.format, layers_of(plan)};
    if (auto held = find_held(request, known)) {
      if (request.target.starts_with("/tiles/") && KnownTargets::may_be_known(request.target)) {
        known_targets_->insert(plan.dataset, request.target, std::move(known));
      }
      return respond(*std::move(held));
    }
    order.may_be_known = false;
  }
  const std::uint64_t most = options_.tile_cost == 0 ? kNoLimit : options_.tile_cost;
  const std::uint64_t cost_to_identify = drawing_cost(plan) + tiles_.cost_of_labels(plan);
  const std::uint64_t cost = cost_to_identify + encoding_cost(plan);
  if (cost > most) return respond(problem_response(too_dear(most)));
  if (auto refusal = find_impatience(request, cost)) return respond(*std::move(refusal));
  if (cost > defaults::kDearTile) order.cost = TileService::Cost::dear;
  if (cost > kGiantTile) order.cost = TileService::Cost::giant;
  // The last answers may come while the service shuts down, after this site is gone.
  auto answer_with = [&cache = cache_, fingerprints = known_fingerprints_, key = order.key, respond,
                      head = TileHead{window.format, options_.cache_control},
                      if_none_match = request.if_none_match, cost](const TileAnswer& answer) {
    if (!answer.is_known()) return respond(undrawn_response(answer.outcome));
    fingerprints->insert(key, answer.tile.fingerprint);
    if (answer.outcome == TileOutcome::drawn) {
      cache.insert(answer.tile.fingerprint, {answer.tile.bytes, answer.tile.hint});
    }
    auto response = answered_response(answer, if_none_match, head);
    response.headers.emplace_back("X-Tile-Cost", std::to_string(cost));
    respond(std::move(response));
  };
  TileService::Holds holds;
  if (!request.if_none_match.empty()) {
    holds = [if_none_match = request.if_none_match](const std::string& fingerprint) {
      return matches_entity_tag(if_none_match, entity_tag_of(fingerprint));
    };
  }
  // A client that has a version of the tile usually has the current one.
  if (holds && order.may_be_known) {
    if (const auto answer = tiles_.answer_at_once(plan, cost_to_identify, holds)) {
      return answer_with(*answer);
    }
  }
  order.plan = std::move(plan);
  const auto ticket = tiles_.submit(std::move(order), std::move(answer_with), std::move(holds));
  if (request.disconnection == nullptr) return;
  request.disconnection->act([&tiles = tiles_, ticket] { tiles.withdraw(ticket); });
}

Result<std::string> Site::base_url(const HttpRequest& request) const {
  if (!options_.public_url.empty()) return options_.public_url;
  if (!is_valid_host(request.host)) {
    return Problem{400,
                   "The request needs a Host header with a host name or address, and a port "
                   "if it is not 80.",
                   "Host", request.host, "a host name or address, with or without a port"};
  }
  if (!options_.allowed_hosts.empty() && !is_allowed_host(request.host, options_.allowed_hosts)) {
    return Problem{400, "This server does not answer for this host name.", "Host", request.host,
                   "one of the names that its configuration allows"};
  }
  return "http://" + request.host;
}

}  // namespace trapeze
