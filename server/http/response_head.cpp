#include "server/http/response_head.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <boost/beast/http/status.hpp>
#include <ctime>
#include <iterator>
#include <string_view>

#include "server/base/build_id.h"

namespace trapeze {
namespace {

std::string http_date(std::time_t time) {
  std::tm parts{};
  gmtime_r(&time, &parts);
  std::array<char, 40> text{};
  const std::size_t length =
      std::strftime(text.data(), text.size(), "%a, %d %b %Y %H:%M:%S GMT", &parts);
  return {text.data(), length};
}

/// Fields of all responses; made once a second.
const std::string& usual_fields() {
  thread_local std::time_t made = -1;
  thread_local std::string fields;
  const std::time_t now = std::time(nullptr);
  if (now != made) {
    fields = fmt::format("Date: {}\r\nServer: trapeze/{}\r\n", http_date(now), version());
    made = now;
  }
  return fields;
}

std::string_view reason_of(int status) {
  namespace http = boost::beast::http;
  const auto reason = http::obsolete_reason(http::int_to_status(static_cast<unsigned>(status)));
  return {reason.data(), reason.size()};
}

}  // namespace

void append_response_head(const HttpResponse& response, unsigned version, bool keep_alive,
                          std::string& text) {
  const auto add = [&text](std::string_view part) { text.append(part); };
  fmt::format_to(std::back_inserter(text), "HTTP/{}.{} {} {}\r\n", version / 10, version % 10,
                 response.status, reason_of(response.status));
  add(usual_fields());
  for (const auto& [name, value] : response.headers) {
    add(name);
    add(": ");
    add(value);
    add("\r\n");
  }
  if (response.body != nullptr) {
    fmt::format_to(std::back_inserter(text), "Content-Length: {}\r\n", response.body->size());
  }
  if (version < 11 && keep_alive) add("Connection: keep-alive\r\n");
  if (version >= 11 && !keep_alive) add("Connection: close\r\n");
  add("\r\n");
}

}  // namespace trapeze
