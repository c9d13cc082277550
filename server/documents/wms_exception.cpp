#include "server/documents/wms_exception.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "render/picture/picture.h"
#include "render/picture/png.h"
#include "render/picture/webp.h"
#include "server/base/xml_text.h"
#include "server/documents/ows_exception.h"
#include "server/documents/wms_request.h"

namespace trapeze {
namespace {

constexpr std::string_view kExceptionHead130 =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<ServiceExceptionReport version="1.3.0" xmlns="http://www.opengis.net/ogc"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xsi:schemaLocation="http://www.opengis.net/ogc http://schemas.opengis.net/wms/1.3.0/exceptions_1_3_0.xsd">
)";

constexpr std::string_view kExceptionHead111 =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<!DOCTYPE ServiceExceptionReport SYSTEM "http://schemas.opengis.net/wms/1.1.1/exception_1_1_1.dtd">
<ServiceExceptionReport version="1.1.1">
)";

constexpr int kExceptionTextSize = 14;
constexpr int kLineHeight = 18;
constexpr int kExceptionMargin = 6;
constexpr Rgba kExceptionInk{0xb0, 0x10, 0x10, 255};

Document report(const Problem& problem, WmsVersion version) {
  const bool is_new = version == WmsVersion::v1_3_0;
  const std::string_view code = code_of(problem);
  const bool has_locator = code != ows::kNoApplicableCode && !problem.parameter.empty();
  std::string xml(is_new ? kExceptionHead130 : kExceptionHead111);
  xml += "  <ServiceException";
  if (code != ows::kNoApplicableCode) xml += fmt::format(" code=\"{}\"", code);
  if (is_new && has_locator) {
    xml += fmt::format(" locator=\"{}\"", xml_escape(echoed(problem.parameter)));
  }
  xml += fmt::format(">{}</ServiceException>\n</ServiceExceptionReport>\n",
                     xml_escape(problem.detail));
  return {is_new ? "text/xml" : "application/vnd.ogc.se_xml", std::move(xml)};
}

/// Draws words from the north-west corner on, as many as there is room for.
void write(std::string_view words, const Fonts& fonts, Picture& picture) {
  const int width = picture.width - 2 * kExceptionMargin;
  std::string line;
  int base = kExceptionMargin + kExceptionTextSize;
  const auto end_line = [&] {
    fonts.draw(line, kExceptionMargin, base, {kExceptionTextSize, kExceptionInk}, picture);
    line.clear();
    base += kLineHeight;
  };
  while (!words.empty() && base < picture.height) {
    const std::string_view word = words.substr(0, words.find(' '));
    words.remove_prefix(std::min(word.size() + 1, words.size()));
    std::string longer = line.empty() ? std::string(word) : fmt::format("{} {}", line, word);
    if (!line.empty() && fonts.width_of(longer, kExceptionTextSize) > width) {
      end_line();
      longer = word;
    }
    line = std::move(longer);
  }
  if (!line.empty()) end_line();
}

Document picture_of(const Problem& problem, const WmsExceptionRequest& asked, const Fonts& fonts) {
  Picture picture;
  picture.width = asked.width;
  picture.height = asked.height;
  picture.pixels.assign(
      static_cast<std::size_t>(asked.width) * static_cast<std::size_t>(asked.height),
      asked.background);
  if (asked.exceptions == WmsExceptions::in_image) write(problem.detail, fonts, picture);
  const RunPicture runs = to_runs(picture);
  if (asked.format == TileFormat::webp) return {std::string(kWmsWebp), encode_webp(runs)};
  return {std::string(kWmsPng), PngEncoder().encode(runs)};
}

}  // namespace

Document wms_exception(const Problem& problem, std::span<const QueryPair> query, const Fonts& fonts,
                       std::uint64_t most_pixels) {
  const WmsExceptionRequest asked = parse_wms_exceptions(query);
  const auto pixels =
      static_cast<std::uint64_t>(asked.width) * static_cast<std::uint64_t>(asked.height);
  const bool is_too_large =
      asked.format == TileFormat::webp && std::max(asked.width, asked.height) > kMaxWebpPixels;
  if (asked.exceptions == WmsExceptions::xml || pixels == 0 || pixels > most_pixels ||
      is_too_large) {
    return report(problem, asked.version);
  }
  return picture_of(problem, asked, fonts);
}

}  // namespace trapeze
