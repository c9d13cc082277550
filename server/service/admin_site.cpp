#include "server/service/admin_site.h"

#include "server/base/build_id.h"
#include "server/base/json_text.h"
#include "server/base/url.h"
#include "server/documents/routes.h"

namespace trapeze {
namespace {

HttpResponse plain(int status, std::string_view content_type, std::string body) {
  HttpResponse response;
  response.status = status;
  response.headers = {{"Content-Type", std::string(content_type)}, {"Cache-Control", "no-store"}};
  response.body = std::make_shared<const std::string>(std::move(body));
  return response;
}

std::string_view status_of(const ServerFigures& figures) {
  if (figures.data == nullptr) return "loading";
  return figures.is_stopping ? "stopping" : "ready";
}

HttpResponse nothing_here() {
  return problem_response({404, "There are /metrics, /ready and /health here."});
}

Json layer_json(const ServedLayer& served) {
  return {{"name", served.config.name},
          {"file", served.report.path},
          {"features", served.report.loaded},
          {"skipped", served.report.skipped},
          {"vertices", served.layer->size().vertices},
          {"bytes", served.layer->memory() + served.layer->features().memory()},
          {"seconds", served.report.total_seconds}};
}

}  // namespace

std::string state_json(const ServerFigures& figures, const std::string& problem) {
  Json json;
  json["status"] = status_of(figures);
  json["version"] = version();
  json["build"] = build_id();
  json["renderer"] = figures.renderer;
  json["last_load_problem"] = problem.empty() ? Json(nullptr) : Json(problem);
  json["connections"] = figures.connections;
  json["tiles"] = {{"waiting", figures.tiles.waiting}, {"drawing", figures.tiles.drawing}};
  json["cache"] = {{"bytes", figures.cache.bytes}, {"tiles", figures.cache.tiles}};
  json["generation"] = figures.data == nullptr ? Json(nullptr) : Json(figures.data->generation());
  json["layers"] = Json::array();
  if (figures.data != nullptr) {
    for (const ServedLayer& served : figures.data->layers()) {
      json["layers"].push_back(layer_json(served));
    }
  }
  return to_text(json);
}

HttpResponse AdminSite::answer(const HttpRequest& request) const {
  if (request.method != "GET" && request.method != "HEAD") {
    auto response = problem_response(
        {405, "Only GET and HEAD are understood here.", "method", request.method, "GET, HEAD"});
    response.headers.emplace_back("Allow", "GET, HEAD");
    return response;
  }
  const auto target = split_target(request.target);
  const std::string_view path = target ? target->path : std::string_view();
  const Area area = area_of(path);
  if (path.size() != 1 + name_of(area).size()) return nothing_here();
  switch (area) {
    case Area::metrics:
      return plain(200, Metrics::kContentType, sources_.metrics());
    case Area::ready:
      return answer_ready();
    case Area::health:
      return plain(200, "application/json", "{\"status\": \"ok\"}\n");
    default:
      return nothing_here();
  }
}

HttpResponse AdminSite::answer_ready() const {
  const ServerFigures figures = sources_.figures();
  const bool is_ready = figures.data != nullptr && !figures.is_stopping;
  return plain(is_ready ? 200 : 503, "application/json", state_json(figures, sources_.problem()));
}

}  // namespace trapeze
