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
  return problem_response({404, "Available here: /metrics, /ready, /health and /changes."});
}

Json layer_json(const ServedLayer& served) {
  return {{"name", served.config.name},
          {"file", served.report.path},
          {"features", served.report.loaded},
          {"skipped", served.report.skipped},
          {"vertices", served.size().vertices},
          {"bytes", served.memory_of_tested()},
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
    for (const ServedLayer& served : figures.data->layers_on_all_grids()) {
      json["layers"].push_back(layer_json(served));
    }
  }
  return to_text(json);
}

HttpResponse AdminSite::answer(const HttpRequest& request) const {
  if (request.method != "GET" && request.method != "HEAD") {
    auto response = problem_response(
        {405, "Only GET and HEAD are supported here.", "method", request.method, "GET, HEAD"});
    response.headers.emplace_back("Allow", "GET, HEAD");
    return response;
  }
  const auto target = split_target(request.target);
  const std::string_view path = target ? target->path : std::string_view();
  if (path == "/changes") return answer_changes(*target);
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

HttpResponse AdminSite::answer_changes(const Target& target) const {
  if (sources_.changes == nullptr) {
    return problem_response(
        {404, "Changes are not tracked: changes.zooms is not set in the configuration."});
  }
  const auto query = decode_query(target.query);
  if (!query || query->size() != 1 || query->front().first != "since") {
    return problem_response({400,
                             "The only parameter is the generation since which to list changes: "
                             "/changes?since=GENERATION."});
  }
  const std::string& since = query->front().second;
  const ServerFigures figures = sources_.figures();
  if (figures.data == nullptr) return problem_response({503, "The data is still being loaded."});
  const std::string& generation = figures.data->generation();
  const ChangeLog::Answer answer = sources_.changes->between(since, generation);
  switch (answer.state) {
    case ChangeLog::Answer::State::pending:
      return problem_response({503, "Changes are still being determined. Try again."});
    case ChangeLog::Answer::State::unknown:
      return problem_response(
          {404,
           "This generation is not among the last ones of this server: all tiles may have changed.",
           "since",
           since,
           {}});
    case ChangeLog::Answer::State::known:
      break;
  }
  return plain(200, "application/json", changes_json(since, generation, answer.layers));
}

}  // namespace trapeze
