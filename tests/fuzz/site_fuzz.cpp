// A whole site, from the request to the bytes of its response. For any request, the response
// matches its status and type, and none reports an internal server error.
//
// Input: a line with method and target, a line with the Host, a line with If-None-Match; the rest
// is the body.
#include <spdlog/spdlog.h>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <future>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/picture/png.h"
#include "render/software/software_renderer.h"
#include "server/service/access_log.h"
#include "server/service/site.h"
#include "server/styles/style_document.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/sample_layers.h"

namespace trapeze {
namespace {

using fuzzing::require;
using nlohmann::json;

/// Renders with one thread, and caches a few tiles.
class FuzzedSite {
 public:
  FuzzedSite() {
    spdlog::set_level(spdlog::level::off);
    data_.set(fuzzing::sample_layers());
  }

  HttpResponse handle(const HttpRequest& request) {
    std::promise<HttpResponse> promise;
    site_.handle(request, [&promise](HttpResponse response) { promise.set_value(response); });
    return promise.get_future().get();
  }

 private:
  static std::vector<std::unique_ptr<MaskRenderer>> renderers() {
    std::vector<std::unique_ptr<MaskRenderer>> renderers;
    renderers.push_back(std::make_unique<SoftwareRenderer>());
    return renderers;
  }
  static TileServiceOptions patient() {
    TileServiceOptions options;
    options.deadline = std::chrono::hours(1);
    return options;
  }
  static SiteOptions options() {
    SiteOptions options;
    options.metrics = [] { return std::string("up 1\n"); };
    options.max_scale = 2;
    options.map_pixels = 1 << 16;
    options.styles.emplace(
        "night", *parse_style_document(
                     R"({"background": "black", "fill": "navy", "water.pattern": "hatch"})"));
    return options;
  }

  CurrentDataset data_;
  TileCache cache_{std::size_t{1} << 16};
  TileService tiles_{patient(), renderers()};
  Site site_{options(), StaticFiles(), data_, tiles_, cache_};
};

std::string_view take_until(char end, std::string_view& text) {
  const std::size_t at = std::min(text.find(end), text.size());
  const std::string_view taken = text.substr(0, at);
  text.remove_prefix(std::min(at + 1, text.size()));
  return taken;
}

HttpRequest request_from(std::string_view text) {
  HttpRequest request;
  std::string_view line = take_until('\n', text);
  request.method = take_until(' ', line);
  request.target = line;
  request.host = take_until('\n', text);
  request.if_none_match = take_until('\n', text);
  request.body = text;
  return request;
}

void check_problem(const HttpResponse& response) {
  require(response.body != nullptr, "a problem has no words");
  require(response.header("Cache-Control") == "no-store", "a problem may be kept");
  if (response.header("Content-Type").find("xml") != std::string_view::npos) {  // of WMTS or WMS
    return require(response.body->find("<ows:Exception exceptionCode=") != std::string::npos ||
                       response.body->find("<ServiceException") != std::string::npos,
                   "a report of exceptions without any");
  }
  require(response.header("Content-Type") == "application/problem+json", "a problem has no type");
  const json problem = json::parse(*response.body, nullptr, false);
  require(problem.is_object() && problem["status"] == response.status,
          "a problem is not what its status says");
}

void check_png(const std::string& bytes) {
  const Picture picture = decode_png(bytes);
  require(picture.width >= 1 && picture.height >= 1, "a picture without pixels");
}

void check_body(const HttpResponse& response) {
  const std::string_view type = response.header("Content-Type");
  require(!type.empty() && response.body != nullptr, "a document without type or bytes");
  const std::string& bytes = *response.body;
  if (type == "image/png") {
    check_png(bytes);
  } else if (type == "image/webp") {
    require(bytes.starts_with("RIFF"), "a WebP that is none");
  } else if (type.find("json") != std::string_view::npos) {
    require(!json::parse(bytes, nullptr, false).is_discarded(), "JSON that is none");
  } else if (type.find("xml") != std::string_view::npos) {
    require(bytes.starts_with("<?xml"), "XML that is none");
  }
}

void check_headers(const HttpResponse& response) {
  for (const auto& [name, value] : response.headers) {
    const bool is_clean = std::ranges::none_of(
        value, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
    require(is_clean, "a header with a control character");
  }
}

void check_response(const HttpResponse& response) {
  constexpr std::array kStatuses = {200, 201, 204, 304, 400, 404, 405,
                                    409, 413, 414, 415, 429, 501};
  require(std::ranges::find(kStatuses, response.status) != kStatuses.end(),
          "status " + std::to_string(response.status));
  check_headers(response);
  if (response.status >= 400) return check_problem(response);
  if (response.status == 204 || response.status == 304) {
    return require(response.body == nullptr, "a body where none can be");
  }
  check_body(response);
}

/// The layer is drawn by the values of a posted table, or the response gives a reason.
void check_table(FuzzedSite& site, const std::string& id, const HttpRequest& request) {
  for (const char* rest : {"&join=name&color-by=value&breaks=jenks:4&ramp=Reds",
                           "&join=rank&color-by=value&classes=*:red&filter=value+IS+NULL"}) {
    for (const char* target : {"/tiles/land/3/4/4.png", "/legend/land.json"}) {
      const HttpResponse drawn =
          site.handle({"GET", target + std::string("?values=") + id + rest, request.host, {}});
      require(drawn.status == 200 || drawn.status == 400, "a posted table cannot be used");
      check_response(drawn);
    }
  }
}

/// A client that already has the content gets 304; a posted style or table exists.
void check_again(FuzzedSite& site, const HttpRequest& request, const HttpResponse& response) {
  if (response.status == 201) {
    const std::string location(response.header("Location"));
    const HttpResponse posted = site.handle({"GET", location, request.host, {}});
    require(posted.status == 200, "what was posted is not where it should be");
    const std::size_t table = location.find("/values/");
    if (table != std::string::npos) check_table(site, location.substr(table + 8), request);
  }
  const std::string tag(response.header("ETag"));
  if (response.status != 200 || tag.empty()) return;
  const HttpResponse again = site.handle({request.method, request.target, request.host, tag});
  require(again.status == 304 && again.header("ETag") == tag, "what has a tag is sent again");
}

void check_log(const HttpRequest& request, const HttpResponse& response) {
  const Answered answered{request, response, {}, 11, request.if_none_match, request.body};
  const std::string text = access_line(answered, LogFormat::text);
  const bool is_one_line = std::ranges::all_of(text, [](char c) { return c >= ' ' && c <= '~'; });
  require(is_one_line, "a request writes into the log what it likes");
  require(!json::parse(access_line(answered, LogFormat::json), nullptr, false).is_discarded(),
          "a line of the log is no JSON");
}

void check(std::string_view text) {
  static FuzzedSite site;
  const HttpRequest request = request_from(text);
  const HttpResponse response = site.handle(request);
  check_response(response);
  check_again(site, request, response);
  check_log(request, response);
}

}  // namespace
}  // namespace trapeze

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  trapeze::check(trapeze::fuzzing::text_of(data, size));
  return 0;
}
