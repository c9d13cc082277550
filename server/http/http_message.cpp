#include "server/http/http_message.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "server/base/trimmed.h"

namespace trapeze {
namespace {

constexpr double kLongestRetrySeconds = 3600;

}  // namespace

HttpResponse problem_response(const Problem& problem) {
  HttpResponse response;
  response.status = problem.status;
  response.headers = {{"Content-Type", "application/problem+json"}, {"Cache-Control", "no-store"}};
  response.body = std::make_shared<const std::string>(problem_json(problem));
  response.problem = std::make_shared<const Problem>(problem);
  if (problem.status == 503) response.headers.emplace_back("Retry-After", "1");
  return response;
}

HttpResponse problem_response(const Problem& problem, std::chrono::duration<double> retry_after) {
  HttpResponse response = problem_response(problem);
  std::erase_if(response.headers, [](const auto& header) { return header.first == "Retry-After"; });
  const double seconds = std::clamp(std::ceil(retry_after.count()), 1.0, kLongestRetrySeconds);
  response.headers.emplace_back("Retry-After", std::to_string(static_cast<int>(seconds)));
  return response;
}

void allow_every_origin(HttpResponse& response) {
  response.headers.emplace_back("Access-Control-Allow-Origin", "*");
  response.headers.emplace_back("Access-Control-Expose-Headers",
                                "Content-Bbox, Content-Crs, ETag, OATiles-hint, Retry-After, "
                                "Server-Timing, X-Cache, X-Tile-Cost");
  response.headers.emplace_back("Timing-Allow-Origin", "*");
}

bool matches_entity_tag(std::string_view if_none_match, std::string_view entity_tag) {
  if (trimmed(if_none_match) == "*") return true;
  // Our own tags contain no comma, so splitting at commas can only break other tags.
  while (!if_none_match.empty()) {
    const std::size_t comma = std::min(if_none_match.find(','), if_none_match.size());
    std::string_view tag = trimmed(if_none_match.substr(0, comma));
    if (tag.starts_with("W/")) tag.remove_prefix(2);
    if (tag == entity_tag) return true;
    if_none_match.remove_prefix(std::min(comma + 1, if_none_match.size()));
  }
  return false;
}

}  // namespace trapeze
