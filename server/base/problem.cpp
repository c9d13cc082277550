#include "server/base/problem.h"

#include "server/base/json_text.h"

namespace trapeze {
namespace {

constexpr std::size_t kMaxEchoedBytes = 64;

std::string cut(const std::string& text) {
  if (text.size() <= kMaxEchoedBytes) return text;
  return text.substr(0, kMaxEchoedBytes) + "...";
}

}  // namespace

std::string_view reason_phrase(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 204:
      return "No Content";
    case 304:
      return "Not Modified";
    case 400:
      return "Bad Request";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 408:
      return "Request Timeout";
    case 413:
      return "Payload Too Large";
    case 414:
      return "URI Too Long";
    case 429:
      return "Too Many Requests";
    case 431:
      return "Request Header Fields Too Large";
    case 500:
      return "Internal Server Error";
    case 503:
      return "Service Unavailable";
    case 504:
      return "Gateway Timeout";
    default:
      return "Unknown";
  }
}

std::string problem_json(const Problem& problem) {
  Json body;
  body["type"] = "about:blank";
  body["title"] = reason_phrase(problem.status);
  body["status"] = problem.status;
  body["detail"] = problem.detail;
  if (!problem.parameter.empty()) {
    body["parameter"] = cut(problem.parameter);
    body["value"] = cut(problem.value);
    body["takes"] = problem.takes;
  }
  return to_text(body);
}

}  // namespace trapeze
