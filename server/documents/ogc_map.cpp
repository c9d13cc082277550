#include "server/documents/ogc_map.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "render/picture/webp.h"
#include "server/data/layer_summary.h"
#include "server/documents/map_picture.h"
#include "server/documents/tile_matrix_set.h"
#include "server/tiles/map_window.h"

namespace trapeze {
namespace {

constexpr std::array<std::string_view, 9> kOwnParameters = {
    "bbox", "bbox-crs", "bgcolor", "collections", "crs", "f", "height", "transparent", "width"};
constexpr std::array<std::string_view, 3> kMetres = {kTileCrsUri, "[EPSG:3857]", "EPSG:3857"};
constexpr std::array<std::string_view, 2> kDegrees = {kDegreesCrsUri, "[OGC:CRS84]"};

bool is_one_of(std::span<const std::string_view> names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

Problem bad_value(std::string_view parameter, const std::string& value, const std::string& takes) {
  return {400, fmt::format("The parameter {} takes {}.", parameter, takes), std::string(parameter),
          value, takes};
}

/// Of all layers together.
Result<WindowSides> sides_of_layers(const std::vector<std::string>& layers,
                                    const DocumentRequest& request) {
  const auto summary = summarize_layers(layers, request.dataset);
  if (!summary) return summary.problem();
  const Box& box = summary->box;
  const bool has_size = !box.is_empty() && box.min_x < box.max_x && box.min_y < box.max_y;
  const Box some = has_size ? box : Box{kGridMin, kGridMin, kGridMax, kGridMax};
  return WindowSides{static_cast<double>(some.min_x), static_cast<double>(some.min_y),
                     static_cast<double>(some.max_x), static_cast<double>(some.max_y)};
}

Result<WindowSides> sides_of(const std::vector<std::string>& layers,
                             const DocumentRequest& request) {
  const std::string* crs = request.find("bbox-crs");
  const bool is_in_metres = crs != nullptr && is_one_of(kMetres, *crs);
  if (crs != nullptr && !is_in_metres && !is_one_of(kDegrees, *crs)) {
    return bad_value("bbox-crs", *crs, fmt::format("{} or {}", kDegreesCrsUri, kTileCrsUri));
  }
  const std::string* text = request.find("bbox");
  if (text == nullptr) return sides_of_layers(layers, request);
  const auto sides = is_in_metres ? parse_window_in_metres(*text) : parse_window_in_degrees(*text);
  if (!sides) {
    return bad_value("bbox", *text,
                     "west, south, east and north, separated by commas, in degrees or as bbox-crs "
                     "says");
  }
  return *sides;
}

/// The format, from what `f` says.
Result<TileFormat> format_of(const DocumentRequest& request) {
  const std::string* name = request.find("f");
  if (name == nullptr || *name == "png") return TileFormat::png;
  if (*name == "webp" && has_webp()) return TileFormat::webp;
  return bad_value("f", *name, has_webp() ? "png or webp" : "png");
}

/// As the standard has it, a map is transparent unless it has a colour to lie on.
Result<std::vector<QueryPair>> background_of(const DocumentRequest& request) {
  const std::string* colour = request.find("bgcolor");
  const std::string* transparent = request.find("transparent");
  if (transparent != nullptr && *transparent != "true" && *transparent != "false") {
    return bad_value("transparent", *transparent, "true or false");
  }
  const bool is_transparent = transparent != nullptr ? *transparent == "true" : colour == nullptr;
  const std::string text = colour != nullptr ? *colour : "FFFFFF";
  const auto parsed = parse_colour(text.starts_with("0x") ? text.substr(2) : text);
  if (!parsed) return bad_value("bgcolor", text, "a colour such as 0xFFFFFF, or its name");
  if (is_transparent) return std::vector<QueryPair>();
  return std::vector<QueryPair>{{"background", to_hex(*parsed)}};
}

}  // namespace

Result<WindowRequest> parse_ogc_map(const std::vector<std::string>& layers,
                                    const DocumentRequest& request) {
  if (const std::string* crs = request.find("crs"); crs != nullptr && !is_one_of(kMetres, *crs)) {
    return bad_value("crs", *crs, std::string(kTileCrsUri));
  }
  const auto format = format_of(request);
  if (!format) return format.problem();
  const auto sides = sides_of(layers, request);
  if (!sides) return sides.problem();
  const auto view = map_view(*sides, request);
  if (!view) return view.problem();
  const auto background = background_of(request);
  if (!background) return background.problem();
  DocumentRequest styled = request;
  if (request.find("background") == nullptr) {
    styled.query.insert(styled.query.end(), background->begin(), background->end());
  }
  auto style = styled.style_for(layers, kOwnParameters);
  if (!style) return std::move(style).problem();
  return WindowRequest{layers, *view, 1, *std::move(style), *format, "map"};
}

}  // namespace trapeze
