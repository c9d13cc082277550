#include "server/documents/wms_request.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "core/grid/web_mercator.h"
#include "render/picture/webp.h"
#include "server/base/nearest_name.h"
#include "server/data/layer_summary.h"
#include "server/documents/key_value_pairs.h"
#include "server/documents/map_picture.h"
#include "server/documents/ows_exception.h"
#include "server/documents/place_text.h"
#include "server/tiles/map_window.h"

namespace trapeze {
namespace {

// As spelled in the standard, with those by which clients report the resolution of their screen.
// All other keys in a query are style parameters, or are ignored.
constexpr std::array<std::string_view, 34> kWmsKeys = {
    "SERVICE",
    "REQUEST",
    "VERSION",
    "WMTVER",
    "UPDATESEQUENCE",
    "FORMAT",
    "LAYERS",
    "STYLES",
    "CRS",
    "SRS",
    "BBOX",
    "WIDTH",
    "HEIGHT",
    "TRANSPARENT",
    "BGCOLOR",
    "LAYER",
    "STYLE",
    "EXCEPTIONS",
    "QUERY_LAYERS",
    "INFO_FORMAT",
    "I",
    "J",
    "X",
    "Y",
    "FEATURE_COUNT",
    "DPI",
    "MAP_RESOLUTION",
    "FORMAT_OPTIONS",
    "SLD",
    "SLD_BODY",
    "TIME",
    "ELEVATION",
    "SCALE",
    "SLD_VERSION",
};

constexpr std::string_view kWmsOperations =
    "GetCapabilities, GetMap, GetFeatureInfo or GetLegendGraphic";
constexpr double kLeastDpi = 24;
constexpr double kMostDpi = 1200;
constexpr std::size_t kUsualFeatures = 1;

/// Includes empty items: "a,,b" has three, and "" has one.
std::vector<std::string> items_of(std::string_view list) {
  std::vector<std::string> items;
  while (true) {
    const std::size_t comma = std::min(list.find(','), list.size());
    items.emplace_back(list.substr(0, comma));
    if (comma == list.size()) return items;
    list.remove_prefix(comma + 1);
  }
}

/// If no version is given, it follows from the name of the reference system parameter.
WmsVersion version_of(const KeyValuePairs& pairs) {
  const auto& version = pairs.has("VERSION") ? pairs["VERSION"] : pairs["WMTVER"];
  if (!version || version->empty()) {
    return pairs.has("SRS") && !pairs.has("CRS") ? WmsVersion::v1_1_1 : WmsVersion::v1_3_0;
  }
  return *version < "1.3" ? WmsVersion::v1_1_1 : WmsVersion::v1_3_0;  // some clients send "1.3"
}

Result<WmsRequest> wms_capabilities_of(const KeyValuePairs& pairs) {
  if (auto problem = check(pairs, "SERVICE", "WMS")) return std::move(*problem);
  WmsCapabilitiesRequest request{version_of(pairs)};
  for (const auto& [name, value] : pairs.others) {
    request.query += fmt::format("{}={}&", percent_encode(name), percent_encode(value));
  }
  return WmsRequest(std::move(request));
}

Result<std::vector<std::string>> layers_in(const KeyValuePairs& pairs, std::string_view key,
                                           const Dataset& dataset) {
  const auto& list = pairs[key];
  if (!list || list->empty()) return missing(key, "the names of layers");
  auto layers = parse_layer_list(*list);
  if (!layers) {
    return ows_problem(400, ows::kLayerNotDefined, key, layers.problem().detail, *list);
  }
  for (const std::string& name : *layers) {
    if (!dataset.find(name)) {
      return ows_problem(404, ows::kLayerNotDefined, key, unknown_layer(name, dataset).detail,
                         name);
    }
  }
  return layers;
}

Problem unknown_style(std::string_view key, const std::string& name) {
  return ows_problem(404, ows::kStyleNotDefined, key,
                     fmt::format("There is no style \"{}\": the capabilities list the styles; an "
                                 "empty name is the default style of the layer.",
                                 name),
                     name);
}

bool is_own_style(std::string_view name) {
  return name.empty() || name == StyleBook::kDefaultName;
}

/// A named style for one layer.
struct StyleOfLayer {
  std::string layer;
  std::shared_ptr<const StyleQuery> style;
};

/// What the styles set for their layers, unless the query does: all parameters of a query take
/// precedence over styles, also those for all layers. Settings for the whole picture come from the
/// first style that has them.
Result<StyleQuery> put_together(std::span<const StyleOfLayer> styles,
                                std::span<const QueryPair> query,
                                std::span<const std::string> layers) {
  StyleQuery named;
  if (styles.empty()) return named;
  const auto own = StyleQuery::parse(query, layers);
  if (!own) return own.problem();
  for (const auto& [layer, style] : styles) {
    named = named.over(style->of_layer(layer).without_those_of(*own), layers);
  }
  return named;
}

/// The styles of the layers, one for each or none at all, and the additional settings of the query.
Result<StyleQuery> style_of(std::vector<QueryPair> query, std::span<const std::string> layers,
                            const KeyValuePairs& pairs, const StyleBook& styles) {
  const std::string list = pairs["STYLES"].value_or(std::string());
  const std::vector<std::string> names = items_of(list);
  const std::vector<std::string> of_layers = items_of(*pairs["LAYERS"]);  // with duplicates
  if (!list.empty() && names.size() != of_layers.size()) {
    return ows_problem(400, ows::kStyleNotDefined, "STYLES",
                       "STYLES takes one name for each of LAYERS, or nothing at all.", list);
  }
  std::vector<StyleOfLayer> found;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (is_own_style(names[i])) continue;
    auto style = styles.find(names[i]);
    if (style == nullptr) return unknown_style("STYLES", names[i]);
    found.push_back({of_layers[i], std::move(style)});
  }
  auto named = put_together(found, query, layers);
  if (!named) return std::move(named).problem();
  auto styled = styles.read(std::move(query));  // which names no style itself
  if (!styled) return styled.problem();
  styled->named = std::make_shared<const StyleQuery>(*std::move(named));
  return styled->style_for(layers);
}

std::optional<bool> parse_flag(const std::optional<std::string>& text, bool usual) {
  if (!text || text->empty()) return usual;
  if (is_equal(*text, "TRUE")) return true;
  if (is_equal(*text, "FALSE")) return false;
  return std::nullopt;
}

/// "0xRRGGBB".
std::optional<Rgba> parse_background(const std::optional<std::string>& text) {
  constexpr Rgba kWhite{255, 255, 255, 255};
  if (!text || text->empty()) return kWhite;
  const bool is_hex = text->size() == 8 && (text->starts_with("0x") || text->starts_with("0X"));
  if (is_hex) return parse_colour(std::string_view(*text).substr(2));
  return text->starts_with('#') ? parse_colour(*text) : std::nullopt;
}

/// Parameters after ';' concern palettes, which pictures have if possible.
std::optional<TileFormat> parse_format(std::string_view name) {
  const std::string_view type = name.substr(0, name.find(';'));
  if (is_equal(type, kWmsPng) || is_equal(type, "image/png8")) return TileFormat::png;
  if (is_equal(type, kWmsWebp) && has_webp()) return TileFormat::webp;
  return std::nullopt;
}

Result<double> scale_of(const KeyValuePairs& pairs) {
  constexpr std::string_view kOption = "dpi:";
  std::vector<std::pair<std::string_view, std::string_view>> given;
  for (const std::string_view key : {"DPI", "MAP_RESOLUTION"}) {
    if (pairs.has(key)) given.emplace_back(key, *pairs[key]);
  }
  if (pairs.has("FORMAT_OPTIONS")) {
    const std::string_view options = *pairs["FORMAT_OPTIONS"];
    if (const std::size_t at = options.find(kOption); at != std::string_view::npos) {
      const std::string_view rest = options.substr(at + kOption.size());
      given.emplace_back("FORMAT_OPTIONS", rest.substr(0, rest.find(';')));
    }
  }
  if (given.empty()) return 1.0;
  const auto [key, text] = given.front();
  const auto dpi = parse_number(text, kLeastDpi, kMostDpi);
  if (!dpi) {
    return invalid(key, fmt::format("pixels per inch, from {} to {}", kLeastDpi, kMostDpi),
                   std::string(text));
  }
  return *dpi / kUsualDpi;
}

Result<MapSystemPtr> system_in(const KeyValuePairs& pairs, WmsVersion version,
                               std::span<const std::string> layers, const Dataset& dataset) {
  const bool is_new = version == WmsVersion::v1_3_0;
  const std::string_view key = is_new ? "CRS" : "SRS";
  const auto& name = pairs[key];
  const char* code = is_new ? ows::kInvalidCrs : ows::kInvalidSrs;
  const std::string takes = names_of(map_systems_of(dataset));
  if (!name || name->empty()) return missing(key, takes);
  const MapSystemPtr system = find_map_system(*name, dataset);
  if (system == nullptr) {
    return ows_problem(400, code, key, fmt::format("Maps are available in {} only.", takes), *name);
  }
  for (const std::string& layer : layers) {
    if (served_in(dataset, layer, *system) != nullptr) continue;
    return ows_problem(400, code, key, not_built(layer, *system, dataset).detail, *name);
  }
  return system;
}

/// A description of valid values of BBOX.
std::string words_of_box(const MapSystem& system, AxisOrder order) {
  const bool is_north_first = order == AxisOrder::of_authority && system.is_north_first;
  return fmt::format(
      "{} in {}, separated by commas, the west less than the east and the south less "
      "than the north",
      is_north_first ? "south, west, north and east" : "west, south, east and north",
      system.is_in_degrees          ? "degrees"
      : system.metres_per_unit == 1 ? "metres"
                                    : "units of " + system.name);
}

Result<int> pixels_in(const KeyValuePairs& pairs, std::string_view key) {
  const std::string takes = fmt::format("an integer from 1 to {}", kMaxPicturePixels);
  if (!pairs.has(key)) return missing(key, takes);
  if (const auto pixels = parse_pixels(*pairs[key])) return *pixels;
  return invalid(key, takes, *pairs[key]);
}

Result<View> view_of(const KeyValuePairs& pairs, const MapSystem& system, WmsVersion version) {
  const AxisOrder order =
      version == WmsVersion::v1_3_0 ? AxisOrder::of_authority : AxisOrder::east_first;
  const std::string takes = words_of_box(system, order);
  if (!pairs.has("BBOX")) return missing("BBOX", takes);
  const auto width = pixels_in(pairs, "WIDTH");
  if (!width) return width.problem();
  const auto height = pixels_in(pairs, "HEIGHT");
  if (!height) return height.problem();
  const auto sides = parse_window_in(system, *pairs["BBOX"], order);
  const auto view =
      sides ? view_of_window(*sides, *width, *height, system.projection) : std::nullopt;
  if (!view) return invalid("BBOX", takes, *pairs["BBOX"]);
  return *view;
}

/// For both GetMap and GetFeatureInfo.
Result<WindowRequest> window_in(const KeyValuePairs& pairs, const DocumentRequest& request) {
  for (const std::string_view key : {"SLD", "SLD_BODY"}) {
    if (!pairs.has(key)) continue;
    return ows_problem(501, ows::kOperationNotSupported, key,
                       "Styles are named in STYLES or set by parameters; SLD is not supported.");
  }
  auto layers = layers_in(pairs, "LAYERS", request.dataset);
  if (!layers) return std::move(layers).problem();
  // Duplicates count, as for LayerLimit.
  if (items_of(*pairs["LAYERS"]).size() > request.max_layers) {
    return invalid("LAYERS", fmt::format("at most {} layers", request.max_layers),
                   *pairs["LAYERS"]);
  }
  const auto system = system_in(pairs, version_of(pairs), *layers, request.dataset);
  if (!system) return system.problem();
  const auto view = view_of(pairs, **system, version_of(pairs));
  if (!view) return view.problem();
  const auto scale = scale_of(pairs);
  if (!scale) return scale.problem();
  const auto is_transparent = parse_flag(pairs["TRANSPARENT"], false);
  if (!is_transparent) return invalid("TRANSPARENT", "TRUE or FALSE", *pairs["TRANSPARENT"]);
  const auto background = parse_background(pairs["BGCOLOR"]);
  if (!background) return invalid("BGCOLOR", "a colour such as 0xFFFFFF", *pairs["BGCOLOR"]);
  std::vector<QueryPair> query = pairs.others;
  const bool has_background =
      std::ranges::find(query, "background", &QueryPair::first) != query.end();
  if (!*is_transparent && !has_background) {
    query.emplace_back("background", to_hex(*background));
  }
  auto style = style_of(std::move(query), *layers, pairs, request.styles);
  if (!style) return std::move(style).problem();
  return WindowRequest{*std::move(layers),
                       *view,
                       *scale,
                       *std::move(style),
                       TileFormat::png,
                       fmt::format("{}", *pairs["BBOX"]),
                       *system};
}

Result<WmsRequest> map_of(const KeyValuePairs& pairs, const DocumentRequest& request) {
  auto window = window_in(pairs, request);
  if (!window) return std::move(window).problem();
  const std::string takes =
      has_webp() ? fmt::format("{} or {}", kWmsPng, kWmsWebp) : std::string(kWmsPng);
  if (!pairs.has("FORMAT")) return missing("FORMAT", takes);
  const auto format = parse_format(*pairs["FORMAT"]);
  if (!format) {
    return ows_problem(400, ows::kInvalidFormat, "FORMAT", fmt::format("FORMAT takes {}.", takes),
                       *pairs["FORMAT"]);
  }
  window->format = *format;
  return WmsRequest(*std::move(window));
}

/// A pixel coordinate, counted from 0.
Result<int> pixel_in(const KeyValuePairs& pairs, std::string_view key, int count) {
  const std::string takes = fmt::format("a pixel of the map, from 0 to {}", count - 1);
  if (!pairs.has(key)) return missing(key, takes);
  const auto pixel = parse_number(*pairs[key], 0, count - 1);
  if (!pixel) {
    return ows_problem(400, ows::kInvalidPoint, key, fmt::format("{} takes {}.", key, takes),
                       *pairs[key]);
  }
  return static_cast<int>(*pixel);
}

Result<std::size_t> feature_count_of(const KeyValuePairs& pairs) {
  if (!pairs.has("FEATURE_COUNT")) return kUsualFeatures;
  const auto count = parse_number(*pairs["FEATURE_COUNT"], 1, 1e9);
  if (!count) return invalid("FEATURE_COUNT", "an integer from 1", *pairs["FEATURE_COUNT"]);
  return static_cast<std::size_t>(*count);
}

Result<WmsRequest> info_of(const KeyValuePairs& pairs, const DocumentRequest& request) {
  auto window = window_in(pairs, request);
  if (!window) return std::move(window).problem();
  auto layers = layers_in(pairs, "QUERY_LAYERS", request.dataset);
  if (!layers) return std::move(layers).problem();
  for (const std::string& name : *layers) {
    if (std::ranges::find(window->layers, name) != window->layers.end()) continue;
    return ows_problem(400, ows::kLayerNotDefined, "QUERY_LAYERS",
                       "QUERY_LAYERS takes some of LAYERS.", name);
  }
  const bool is_new = version_of(pairs) == WmsVersion::v1_3_0;
  const auto column = pixel_in(pairs, is_new ? "I" : "X", window->view.width);
  if (!column) return column.problem();
  const auto row = pixel_in(pairs, is_new ? "J" : "Y", window->view.height);
  if (!row) return row.problem();
  const auto count = feature_count_of(pairs);
  if (!count) return count.problem();
  const std::string name =
      pairs.has("INFO_FORMAT") ? *pairs["INFO_FORMAT"] : std::string("text/plain");
  const auto format = std::ranges::find_if(
      info_formats(), [&name](const InfoFormat& known) { return is_equal(known.name, name); });
  if (format == info_formats().end()) {
    return ows_problem(400, ows::kInvalidFormat, "INFO_FORMAT",
                       "INFO_FORMAT takes application/geo+json, application/json, text/plain or "
                       "text/html.",
                       name);
  }
  const auto place = place_at(window->view, *column + 0.5, *row + 0.5);
  const double zoom =
      std::clamp<double>(window->system->zoom_of(window->view, window->scale), 0, kMaxZoom);
  PlaceQuery query{*std::move(layers),       place.value_or(Point{}), zoom,
                   std::move(window->style), place ? *count : 0,      window->system};
  return WmsRequest(
      WmsFeatureInfoRequest{std::move(query), format->format, std::string(format->content_type)});
}

Result<WmsRequest> legend_of(const KeyValuePairs& pairs, const DocumentRequest& request) {
  auto layers = layers_in(pairs, "LAYER", request.dataset);
  if (!layers) return std::move(layers).problem();
  const std::string name = pairs.has("FORMAT") ? *pairs["FORMAT"] : std::string(kWmsPng);
  const bool is_json = is_equal(name, "application/json");
  const auto format = parse_format(name);
  if (!is_json && format != TileFormat::png) {
    return ows_problem(400, ows::kInvalidFormat, "FORMAT",
                       "FORMAT takes image/png or application/json for legends.", name);
  }
  const auto scale = scale_of(pairs);
  if (!scale) return scale.problem();
  WmsLegendRequest legend{{}, pairs.others};
  if (const auto& asked = pairs["STYLE"]; asked && !is_own_style(*asked)) {
    const auto style = request.styles.find(*asked);
    if (style == nullptr) return unknown_style("STYLE", *asked);
    std::vector<StyleOfLayer> for_layers;
    for (const std::string& layer : *layers) for_layers.push_back({layer, style});
    auto named = put_together(for_layers, legend.query, *layers);
    if (!named) return std::move(named).problem();
    legend.named = std::make_shared<const StyleQuery>(*std::move(named));
  }
  const int whole = std::clamp(static_cast<int>(std::lround(*scale)), 1, kMaxScale);
  legend.file = fmt::format("{}{}", fmt::join(*layers, ","),
                            is_json ? ".json" : scale_suffix(whole) + ".png");
  return WmsRequest(std::move(legend));
}

Result<WmsRequest> parse_pairs(const KeyValuePairs& pairs, const DocumentRequest& request) {
  if (!pairs.has("REQUEST")) return missing("REQUEST", kWmsOperations);
  const std::string& operation = *pairs["REQUEST"];
  if (is_equal(operation, "GetCapabilities") || is_equal(operation, "capabilities")) {
    return wms_capabilities_of(pairs);
  }
  if (pairs.has("SERVICE")) {
    if (auto problem = check(pairs, "SERVICE", "WMS")) return std::move(*problem);
  }
  if (is_equal(operation, "GetMap")) return map_of(pairs, request);
  if (is_equal(operation, "GetFeatureInfo")) return info_of(pairs, request);
  if (is_equal(operation, "GetLegendGraphic")) return legend_of(pairs, request);
  return ows_problem(501, ows::kOperationNotSupported, "REQUEST",
                     fmt::format("REQUEST takes {}.", kWmsOperations), operation);
}

WmsExceptions parse_exceptions(const std::optional<std::string>& text) {
  if (!text) return WmsExceptions::xml;
  const std::string lower = in_lower_case(*text);
  if (lower == "inimage" || lower.ends_with("_inimage")) return WmsExceptions::in_image;
  if (lower == "blank" || lower.ends_with("_blank")) return WmsExceptions::blank;
  return WmsExceptions::xml;
}

}  // namespace

std::string_view name_of(WmsVersion version) {
  return version == WmsVersion::v1_1_1 ? "1.1.1" : "1.3.0";
}

Result<WmsRequest> parse_wms_request(const DocumentRequest& request) {
  if (request.path.size() != 1) {
    return Problem{404, "There is nothing here. WMS is at /wms, by key-value pairs."};
  }
  const auto pairs = divide(request.query, kWmsKeys);
  if (!pairs) return pairs.problem();
  return parse_pairs(*pairs, request);
}

WmsExceptionRequest parse_wms_exceptions(std::span<const QueryPair> query) {
  WmsExceptionRequest request;
  const auto divided = divide(query, kWmsKeys);
  if (!divided) return request;
  const KeyValuePairs& pairs = *divided;
  request.version = version_of(pairs);
  request.exceptions = parse_exceptions(pairs["EXCEPTIONS"]);
  const auto text_of = [&pairs](std::string_view key) {
    return pairs[key].value_or(std::string());
  };
  request.width = parse_pixels(text_of("WIDTH")).value_or(0);
  request.height = parse_pixels(text_of("HEIGHT")).value_or(0);
  request.format = parse_format(text_of("FORMAT")).value_or(TileFormat::png);
  if (parse_flag(pairs["TRANSPARENT"], false) == false) {
    request.background = parse_background(pairs["BGCOLOR"]).value_or(Rgba{255, 255, 255, 255});
  }
  return request;
}

}  // namespace trapeze
