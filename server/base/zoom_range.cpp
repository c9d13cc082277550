#include "server/base/zoom_range.h"

#include <charconv>

#include "core/grid/web_mercator.h"

namespace trapeze {
namespace {

std::optional<int> parse_zoom(std::string_view text) {
  int zoom = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), zoom);
  const bool is_whole = error == std::errc() && end == text.data() + text.size();
  return is_whole && 0 <= zoom && zoom <= kMaxZoom ? std::optional(zoom) : std::nullopt;
}

}  // namespace

std::optional<ZoomRange> parse_zooms(std::string_view text) {
  const std::size_t dash = text.find('-');
  const auto first = parse_zoom(text.substr(0, dash));
  const auto last = dash == std::string_view::npos ? first : parse_zoom(text.substr(dash + 1));
  if (!first || !last || *first > *last) return std::nullopt;
  return ZoomRange{*first, *last};
}

}  // namespace trapeze
