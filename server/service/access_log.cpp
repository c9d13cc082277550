#include "server/service/access_log.h"

#include <fmt/format.h>
#include <spdlog/fmt/chrono.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <ctime>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "server/base/json_text.h"
#include "server/service/line_writer.h"

namespace trapeze {
namespace {

/// Escaped for use between quotes: it cannot end the quotes or the line.
std::string escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      escaped += '\\';
      escaped += c;
    } else if (c >= ' ' && c <= '~') {
      escaped += c;
    } else {
      escaped += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
  }
  return escaped.empty() ? "-" : escaped;
}

/// The bytes of the body that are sent: HEAD is answered without one.
std::size_t bytes_of(const Answered& answered) {
  const bool has_body = answered.response.body != nullptr && answered.request.method != "HEAD";
  return has_body ? answered.response.body->size() : 0;
}

std::string text_line(const Answered& answered, std::time_t now) {
  const HttpRequest& request = answered.request;
  return fmt::format(
      R"({} - - [{:%d/%b/%Y:%H:%M:%S} +0000] "{} {} HTTP/{}.{}" {} {} "{}" "{}" {:.6f} {})",
      address_text(request.client), fmt::gmtime(now), escaped(request.method),
      escaped(request.target), answered.version / 10, answered.version % 10,
      answered.response.status, bytes_of(answered), escaped(answered.referer),
      escaped(answered.user_agent), answered.duration.count(),
      escaped(answered.response.header("X-Cache")));
}

std::string json_line(const Answered& answered, std::time_t now) {
  const HttpRequest& request = answered.request;
  Json line;
  line["time"] = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
  line["client"] = address_text(request.client);
  line["method"] = request.method;
  line["target"] = request.target;
  line["host"] = request.host;
  line["status"] = answered.response.status;
  line["bytes"] = bytes_of(answered);
  line["seconds"] = answered.duration.count();
  const std::string_view cache = answered.response.header("X-Cache");
  if (!cache.empty()) line["cache"] = cache;
  if (!answered.referer.empty()) line["referer"] = answered.referer;
  if (!answered.user_agent.empty()) line["user_agent"] = answered.user_agent;
  return line.dump(-1, ' ', /*ensure_ascii=*/true, Json::error_handler_t::replace);
}

std::shared_ptr<const LineFile> open_file(const std::string& target) {
  try {
    return std::make_shared<LineFile>(target);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("log of requests: {}", error.what()));
  }
}

void warn_of_lost_request_lines(std::uint64_t lines) {
  spdlog::warn(fmt::format(
      "request log: {} lines were lost because they could not be written in time", lines));
}

void tell_failure(const std::string& words) {
  spdlog::error(fmt::format("request log: cannot write: {}", words));
}

}  // namespace

std::string access_line(const Answered& answered, LogFormat format) {
  const std::time_t now = std::time(nullptr);
  return format == LogFormat::json ? json_line(answered, now) : text_line(answered, now);
}

AccessLog::AccessLog(std::string target, LogFormat format)
    : target_(std::move(target)),
      format_(format),
      writer_(std::make_unique<LineWriter>(
          open_file(target_), LineWriter::Events{warn_of_lost_request_lines, tell_failure})) {}

AccessLog::~AccessLog() = default;

void AccessLog::write(const Answered& answered) {
  writer_->write(access_line(answered, format_));
}

void AccessLog::reopen() {
  try {
    writer_->redirect(open_file(target_));
  } catch (const std::exception& error) {
    spdlog::error(error.what());
  }
}

void AccessLog::flush() {
  writer_->flush(std::chrono::seconds(1));
}

}  // namespace trapeze
