#include "server/site.h"

#include <spdlog/spdlog.h>

#include <exception>
#include <utility>

#include "server/catalog.h"
#include "server/content_hash.h"
#include "server/url.h"

namespace trapeze {
namespace {

constexpr std::string_view kMethods = "GET, HEAD, OPTIONS";
constexpr std::string_view kTileCaching = "public, max-age=3600";
// Documents and the viewer may change with every start: ask again, and mostly hear 304.
constexpr std::string_view kDocumentCaching = "no-cache";

Problem still_loading() {
  return {503, "The data is still being loaded."};
}

void allow_every_origin(HttpResponse& response) {
  response.headers.emplace_back("Access-Control-Allow-Origin", "*");
  response.headers.emplace_back("Access-Control-Expose-Headers",
                                "ETag, Retry-After, Server-Timing");
  response.headers.emplace_back("Timing-Allow-Origin", "*");
}

HttpResponse answer_options() {
  HttpResponse response;
  response.status = 204;
  response.headers = {{"Allow", std::string(kMethods)},
                      {"Access-Control-Allow-Methods", std::string(kMethods)},
                      {"Access-Control-Allow-Headers", "*"},
                      {"Access-Control-Max-Age", "86400"}};
  return response;
}

HttpResponse refuse_method(const std::string& method) {
  auto response = problem_response({405, "Only GET, HEAD and OPTIONS are understood here.",
                                    "method", method, std::string(kMethods)});
  response.headers.emplace_back("Allow", std::string(kMethods));
  return response;
}

/// 200 with the document, or 304 if the client has it already.
HttpResponse document(const HttpRequest& request, std::string_view content_type,
                      const std::string& entity_tag, std::shared_ptr<const std::string> body) {
  HttpResponse response;
  response.headers = {{"ETag", entity_tag}, {"Cache-Control", std::string(kDocumentCaching)}};
  if (matches_entity_tag(request.if_none_match, entity_tag)) {
    response.status = 304;
    return response;
  }
  response.headers.emplace_back("Content-Type", std::string(content_type));
  response.body = std::move(body);
  return response;
}

HttpResponse json_document(const HttpRequest& request, std::string json) {
  ContentHash hash;
  hash.add(json);
  return document(request, "application/json", fmt::format("\"{:016x}\"", hash.value()),
                  std::make_shared<const std::string>(std::move(json)));
}

std::string server_timing(const PaintTimes& times) {
  return fmt::format("select;dur={:.3f}, draw;dur={:.3f}, compose;dur={:.3f}, encode;dur={:.3f}",
                     times.select_ms, times.draw_ms, times.compose_ms, times.encode_ms);
}

HttpResponse tile_headers(int status, const std::string& entity_tag) {
  HttpResponse response;
  response.status = status;
  response.headers = {{"ETag", entity_tag}, {"Cache-Control", std::string(kTileCaching)}};
  return response;
}

HttpResponse tile_response(const TileAnswer& answer, const std::string& entity_tag) {
  switch (answer.outcome) {
    case TileOutcome::drawn:
      break;
    case TileOutcome::saturated:
      return problem_response({503, "There is more to draw than can be drawn. Ask again."});
    case TileOutcome::late:
      return problem_response({504, "The tile was not drawn in time."});
    case TileOutcome::failed:
      return problem_response({500, "The tile could not be drawn."});
  }
  auto response = tile_headers(200, entity_tag);
  response.headers.emplace_back("Content-Type", "image/png");
  response.headers.emplace_back("Server-Timing", server_timing(answer.times));
  response.body = answer.png;
  return response;
}

}  // namespace

Site::Site(std::string public_url, StaticFiles files, const CurrentDataset& data,
           TileService& tiles)
    : public_url_(std::move(public_url)), files_(std::move(files)), data_(data), tiles_(tiles) {}

void Site::handle(const HttpRequest& request, Respond respond) const {
  const auto respond_to_all = [respond = std::move(respond)](HttpResponse response) {
    allow_every_origin(response);
    respond(std::move(response));
  };
  if (request.method == "OPTIONS") return respond_to_all(answer_options());
  if (request.method != "GET" && request.method != "HEAD") {
    return respond_to_all(refuse_method(request.method));
  }
  if (request.target.size() > kMaxTargetLength) {
    return respond_to_all(problem_response(
        {414, fmt::format("A target is at most {} bytes long.", kMaxTargetLength)}));
  }
  if (const auto target = split_target(request.target);
      target && target->path.starts_with("/tiles/")) {
    return handle_tiles(request, respond_to_all);
  }
  respond_to_all(route(request));
}

HttpResponse Site::route(const HttpRequest& request) const {
  const auto target = split_target(request.target);
  const std::string_view path = target ? target->path : std::string_view();
  if (path == "/health") return answer_health();
  if (path == "/ready") return answer_ready();
  if (path == "/catalog") return answer_catalog(request);
  return answer_file(request);
}

HttpResponse Site::answer_health() const {
  HttpResponse response;
  response.headers = {{"Content-Type", "application/json"}, {"Cache-Control", "no-store"}};
  response.body = std::make_shared<const std::string>("{\"status\": \"ok\"}\n");
  return response;
}

HttpResponse Site::answer_ready() const {
  if (data_.get() == nullptr) return problem_response(still_loading());
  HttpResponse response;
  response.headers = {{"Content-Type", "application/json"}, {"Cache-Control", "no-store"}};
  response.body = std::make_shared<const std::string>("{\"status\": \"ready\"}\n");
  return response;
}

HttpResponse Site::answer_catalog(const HttpRequest& request) const {
  const auto dataset = data_.get();
  if (dataset == nullptr) return problem_response(still_loading());
  const auto base = base_url(request);
  if (const auto* problem = std::get_if<Problem>(&base)) return problem_response(*problem);
  return json_document(request,
                       catalog_json(*dataset, tiles_.renderer_name(), std::get<std::string>(base)));
}

HttpResponse Site::answer_tile_json(const TileJsonRequest& tiles,
                                    const HttpRequest& request) const {
  const auto dataset = data_.get();
  if (dataset == nullptr) return problem_response(still_loading());
  const auto base = base_url(request);
  if (const auto* problem = std::get_if<Problem>(&base)) return problem_response(*problem);
  auto json = tile_json(tiles, *dataset, std::get<std::string>(base));
  if (const auto* problem = std::get_if<Problem>(&json)) return problem_response(*problem);
  return json_document(request, std::move(std::get<std::string>(json)));
}

HttpResponse Site::answer_file(const HttpRequest& request) const {
  const auto target = split_target(request.target);
  const auto path = target ? percent_decode(target->path, Plus::literal) : std::nullopt;
  if (!path) return problem_response({400, "The target is not well formed."});
  const StaticFile* file = files_.find(*path);
  if (file == nullptr) {
    return problem_response({404, *path == "/"
                                      ? "There is no viewer here: web_root is not set, or has "
                                        "no index.html. The layers are at /catalog."
                                      : "There is nothing here. The layers are at /catalog."});
  }
  return document(request, file->content_type, file->entity_tag, file->bytes);
}

void Site::handle_tiles(const HttpRequest& request, const Respond& respond) const {
  const auto parsed = parse_tiles_target(request.target);
  if (const auto* problem = std::get_if<Problem>(&parsed)) {
    return respond(problem_response(*problem));
  }
  const auto& tiles = std::get<TilesRequest>(parsed);
  if (const auto* tile_json = std::get_if<TileJsonRequest>(&tiles)) {
    return respond(answer_tile_json(*tile_json, request));
  }
  handle_tile(std::get<TileRequest>(tiles), request, respond);
}

void Site::handle_tile(const TileRequest& tile, const HttpRequest& request,
                       const Respond& respond) const {
  auto dataset = data_.get();
  if (dataset == nullptr) return respond(problem_response(still_loading()));
  auto planned = plan_tile(tile, std::move(dataset));
  if (const auto* problem = std::get_if<Problem>(&planned)) {
    return respond(problem_response(*problem));
  }
  auto& plan = std::get<TilePlan>(planned);
  const std::string entity_tag = plan.entity_tag();
  if (matches_entity_tag(request.if_none_match, entity_tag)) {
    return respond(tile_headers(304, entity_tag));
  }
  tiles_.submit(std::move(plan), [respond, entity_tag](const TileAnswer& answer) {
    respond(tile_response(answer, entity_tag));
  });
}

OrProblem<std::string> Site::base_url(const HttpRequest& request) const {
  if (!public_url_.empty()) return public_url_;
  if (!is_valid_host(request.host)) {
    return Problem{400,
                   "The request needs a Host header with a host name or address, and a port "
                   "if it is not 80.",
                   "Host", request.host, "a host name or address, with or without a port"};
  }
  return "http://" + request.host;
}

}  // namespace trapeze
