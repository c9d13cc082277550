#include "server/base/problem.h"

#include <boost/beast/http/status.hpp>
#include <string_view>

#include "server/base/json_text.h"

namespace trapeze {
namespace {

constexpr std::size_t kMaxEchoedBytes = 64;

}  // namespace

std::string echoed(const std::string& text) {
  if (text.size() <= kMaxEchoedBytes) return text;
  return text.substr(0, kMaxEchoedBytes) + "...";
}

std::string problem_json(const Problem& problem) {
  Json body;
  body["type"] = "about:blank";
  const auto reason = boost::beast::http::obsolete_reason(
      boost::beast::http::int_to_status(static_cast<unsigned>(problem.status)));
  body["title"] = std::string_view(reason.data(), reason.size());
  body["status"] = problem.status;
  body["detail"] = problem.detail;
  if (!problem.parameter.empty()) {
    body["parameter"] = echoed(problem.parameter);
    body["value"] = echoed(problem.value);
    body["takes"] = problem.takes;
  }
  return to_text(body);
}

}  // namespace trapeze
