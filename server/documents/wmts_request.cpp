#include "server/documents/wmts_request.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/web_mercator.h"
#include "render/mask/mask.h"
#include "render/mask/stroke.h"
#include "server/data/layer_summary.h"
#include "server/documents/key_value_pairs.h"
#include "server/documents/ows_exception.h"
#include "server/labels/label_style.h"
#include "server/tiles/map_window.h"
#include "server/tiles/window_request.h"

namespace trapeze {
namespace {

// As spelled in the standard. All other keys in a query are style parameters, or are ignored.
constexpr std::array<std::string_view, 15> kWmtsKeys = {
    "Service", "Request", "Version",       "AcceptVersions", "Sections", "Layer",
    "Style",   "Format",  "TileMatrixSet", "TileMatrix",     "TileRow",  "TileCol",
    "I",       "J",       "InfoFormat",
};
constexpr std::string_view kWmtsOperations = "GetCapabilities, GetTile or GetFeatureInfo";
constexpr std::string_view kSections =
    "some of ServiceIdentification, ServiceProvider, OperationsMetadata, Contents, Themes, or All";

Result<WmtsRequest> wmts_capabilities_of(const KeyValuePairs& pairs) {
  if (const auto& versions = pairs["AcceptVersions"]; versions && !versions->empty()) {
    const auto accepted = split_list(*versions);
    if (std::ranges::find(accepted, kWmtsVersion) == accepted.end()) {
      // The standard requires that there is no locator.
      return ows_problem(400, ows::kVersionNegotiationFailed, {},
                         fmt::format("Only version {} of WMTS is supported.", kWmtsVersion),
                         *versions);
    }
  }
  WmtsCapabilitiesRequest request;
  const auto& sections = pairs["Sections"];
  if (!sections) return WmtsRequest(request);
  if (sections->empty()) return missing("Sections", kSections);
  request = {false, false, false};
  for (const std::string_view section : split_list(*sections)) {
    const bool is_all = is_equal(section, "All");
    const bool is_identification = is_equal(section, "ServiceIdentification");
    const bool is_operations = is_equal(section, "OperationsMetadata");
    const bool is_contents = is_equal(section, "Contents");
    // These sections have no contents here.
    const bool is_empty = is_equal(section, "ServiceProvider") || is_equal(section, "Themes");
    if (!is_all && !is_identification && !is_operations && !is_contents && !is_empty) {
      return invalid("Sections", kSections, *sections);
    }
    request.identification |= is_all || is_identification;
    request.operations |= is_all || is_operations;
    request.contents |= is_all || is_contents;
  }
  return WmtsRequest(request);
}

/// The parts of a request for a tile, as text.
struct TileParts {
  std::string layer;
  std::string style;
  std::string matrix_set;
  std::string matrix;
  std::string row;
  std::string column;
  std::vector<QueryPair> others;
};

enum class NumberKind : std::uint8_t { number, outside, none };

struct ParsedNumber {
  NumberKind kind = NumberKind::none;
  std::uint32_t value = 0;
};

/// An integer that is negative or too long is valid, but outside every range.
ParsedNumber parse_number(std::string_view text) {
  const bool is_negative = text.starts_with('-');
  const std::string_view digits = text.substr(is_negative ? 1 : 0);
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (digits.empty() || !std::ranges::all_of(digits, is_digit)) return {};
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (is_negative || error != std::errc()) return {NumberKind::outside, 0};
  return {NumberKind::number, value};
}

/// A number from `min` to `max`; the problem for one outside has the given code.
Result<std::uint32_t> number_in(std::string_view key, const std::string& text, std::uint32_t min,
                                std::uint32_t max, const char* code, int status) {
  const std::string takes = fmt::format("an integer from {} to {} here", min, max);
  const ParsedNumber number = parse_number(text);
  if (number.kind == NumberKind::none) return invalid(key, takes, text);
  if (number.kind == NumberKind::outside || number.value < min || number.value > max) {
    return ows_problem(status, code, key, fmt::format("{} takes {}.", key, takes), text);
  }
  return number.value;
}

/// The index of a matrix in the set.
Result<std::size_t> matrix_in(const TileMatrixSet& set, const std::string& name) {
  if (const TileMatrix* matrix = set.find(name)) {
    return static_cast<std::size_t>(matrix - set.matrices.data());
  }
  return invalid("TileMatrix",
                 fmt::format("{} to {}", set.matrices.front().id, set.matrices.back().id), name,
                 404);
}

Result<std::vector<std::string>> layers_of(const std::string& list, const Dataset& dataset) {
  auto layers = parse_layer_list(list);
  if (!layers) {
    layers.problem().parameter = "Layer";
    layers.problem().code = ows::kInvalidParameterValue;
    return layers;
  }
  for (const std::string& name : *layers) {
    if (dataset.find(name)) continue;
    Problem problem = unknown_layer(name, dataset);
    problem.parameter = "Layer";
    problem.code = ows::kInvalidParameterValue;
    return problem;
  }
  return layers;
}

/// How far outside its bounds the layer may show something in a style, in pixels.
double margin_of(const StyleQuery& style, const LayerConfig& config) {
  constexpr double kHalfOfWidestLine = 16;
  const StyleQuery shown = style.with_defaults(config.name, config.style);
  const auto find = [&](ParameterId parameter) { return shown.find(config.name, parameter); };
  const auto number = [&find](ParameterId parameter, double usual) {
    const ParameterValue* value = find(parameter);
    const double* found = value == nullptr ? nullptr : std::get_if<double>(value);
    return found == nullptr ? usual : *found;
  };
  Stroke stroke;
  stroke.width = number(ParameterId::stroke_width, 1);
  const ParameterValue* join = find(ParameterId::stroke_linejoin);
  if (join != nullptr && format_value(*join) == "miter") stroke.join = LineJoin::miter;
  const double of_shapes = stroke.reach(1) + number(ParameterId::grow, 0) / 2;
  const LabelStyle usual;
  const double of_labels = find(ParameterId::label) == nullptr
                               ? 0
                               : number(ParameterId::label_overhang, usual.overhang) +
                                     number(ParameterId::label_halo_width, usual.halo_width) + 1;
  return std::max({kHalfOfWidestLine, of_shapes, of_labels});
}

/// Of all layers together; nothing at scales at which none of them is drawn.
std::optional<TileLimits> limits_of(std::span<const std::string> layers, const TileMatrixSet& set,
                                    std::size_t matrix, const StyleQuery& style,
                                    const DocumentRequest& request) {
  const Dataset& dataset = request.dataset;
  std::optional<TileLimits> all;
  for (const std::string& name : layers) {
    const ServedLayer& layer = dataset.layers()[*dataset.find(name)];
    if (!has_tiles_of(layer, set.matrices[matrix])) continue;
    const ServedLayer* there = served_in(dataset, name, *set.system);
    if (there == nullptr) continue;
    const double margin =
        std::max(wmts_margin(*there, request.styles), margin_of(style, there->config));
    const TileLimits limits = wmts_limits(*there, set, matrix, margin);
    if (!all) all = limits;
    all->min_row = std::min(all->min_row, limits.min_row);
    all->max_row = std::max(all->max_row, limits.max_row);
    all->min_column = std::min(all->min_column, limits.min_column);
    all->max_column = std::max(all->max_column, limits.max_column);
  }
  return all;
}

Result<TileId> tile_id_of(const TileParts& parts, const TileMatrixSet& set,
                          std::span<const std::string> layers, const StyleQuery& style,
                          const DocumentRequest& request) {
  const auto matrix = matrix_in(set, parts.matrix);
  if (!matrix) return matrix.problem();
  const auto limits = limits_of(layers, set, *matrix, style, request);
  if (!limits) {
    return ows_problem(404, ows::kTileOutOfRange, "TileMatrix",
                       "The layer is not drawn at this TileMatrix.", parts.matrix);
  }
  const auto row =
      number_in("TileRow", parts.row, limits->min_row, limits->max_row, ows::kTileOutOfRange, 404);
  if (!row) return row.problem();
  const auto column = number_in("TileCol", parts.column, limits->min_column, limits->max_column,
                                ows::kTileOutOfRange, 404);
  if (!column) return column.problem();
  return TileId{static_cast<int>(*matrix), *column, *row};
}

Result<StyleQuery> style_of(const TileParts& parts, std::span<const std::string> layers,
                            const StyleBook& styles) {
  std::vector<QueryPair> query = parts.others;
  if (!parts.style.empty()) query.emplace_back("style", parts.style);
  const auto styled = styles.read(std::move(query), 404);
  if (!styled) {
    Problem problem = styled.problem();
    problem.parameter = "Style";
    problem.code = ows::kInvalidParameterValue;
    return problem;
  }
  return styled->style_for(layers);
}

Result<TileRequest> tile_of(const TileParts& parts, const DocumentRequest& request) {
  auto layers = layers_of(parts.layer, request.dataset);
  if (!layers) return std::move(layers).problem();
  auto set = request.sets.find(parts.matrix_set);
  if (set == nullptr || !set->is_from_north()) {
    return invalid("TileMatrixSet", names_of(wmts_sets(request)), parts.matrix_set, 404);
  }
  for (const std::string& name : *layers) {
    if (served_in(request.dataset, name, *set->system) != nullptr) continue;
    return ows_problem(404, ows::kInvalidParameterValue, "TileMatrixSet",
                       not_built(name, *set->system, request.dataset).detail, parts.matrix_set);
  }
  auto style = style_of(parts, *layers, request.styles);
  if (!style) return std::move(style).problem();
  const auto tile = tile_id_of(parts, *set, *layers, *style, request);
  if (!tile) return tile.problem();
  return TileRequest{*std::move(layers), *tile,           1,
                     *std::move(style),  TileFormat::png, std::move(set)};
}

Result<WmtsRequest> info_of(const TileParts& parts, const std::string& i, const std::string& j,
                            const InfoFormat& format, const DocumentRequest& request) {
  auto tile = tile_of(parts, request);
  if (!tile) return std::move(tile).problem();
  const double zoom = std::clamp<double>(tile->zoom(), 0, kMaxZoom);
  const WindowRequest window = window_of(*std::move(tile));
  const View& view = window.view;
  const auto pixel_in = [](std::string_view key, const std::string& text, int pixels) {
    return number_in(key, text, 0, static_cast<std::uint32_t>(pixels - 1), ows::kPointIJOutOfRange,
                     400);
  };
  const auto column = pixel_in("I", i, view.width);
  if (!column) return column.problem();
  const auto row = pixel_in("J", j, view.height);
  if (!row) return row.problem();
  const auto place = place_at(view, *column + 0.5, *row + 0.5);
  PlaceQuery query{window.layers, place.value_or(Point{}), zoom, window.style};
  query.system = window.system;
  if (!place) query.most_of_layer = 0;  // off the map
  return WmtsRequest(
      WmtsFeatureInfoRequest{std::move(query), format.format, std::string(format.content_type)});
}

Result<WmtsRequest> as_request(Result<TileRequest> tile) {
  if (!tile) return std::move(tile).problem();
  return WmtsRequest(*std::move(tile));
}

/// The parts that GetTile and GetFeatureInfo share.
Result<TileParts> parts_of(const KeyValuePairs& pairs) {
  if (auto problem = check(pairs, "Version", kWmtsVersion)) return std::move(*problem);
  TileParts parts;
  const std::initializer_list<std::pair<std::string_view, std::string*>> required = {
      {"Layer", &parts.layer},
      {"TileMatrixSet", &parts.matrix_set},
      {"TileMatrix", &parts.matrix},
      {"TileRow", &parts.row},
      {"TileCol", &parts.column}};
  if (const auto& layer = pairs["Layer"]; !layer || layer->empty()) {
    return missing("Layer", "the identifier of a layer");
  }
  if (!pairs["Style"]) return missing("Style", "the identifier of a style; empty is the default");
  if (auto problem = check(pairs, "Format", kWmtsFormat)) return std::move(*problem);
  for (const auto& [key, value] : required) {
    const auto& given = pairs[key];
    if (!given || given->empty()) return missing(key, "what the capabilities list");
    *value = *given;
  }
  parts.style = *pairs["Style"];
  parts.others = pairs.others;
  return parts;
}

Result<WmtsRequest> key_value_info(const KeyValuePairs& pairs, const DocumentRequest& request) {
  auto parts = parts_of(pairs);
  if (!parts) return std::move(parts).problem();
  for (const std::string_view key : {"I", "J"}) {
    const auto& given = pairs[key];
    if (!given || given->empty()) return missing(key, "a pixel of the tile, from 0");
  }
  const std::string takes = "application/geo+json, application/json, text/plain or text/html";
  const auto& name = pairs["InfoFormat"];
  if (!name || name->empty()) return missing("InfoFormat", takes);
  const auto format = std::ranges::find_if(
      info_formats(), [&name](const InfoFormat& known) { return is_equal(known.name, *name); });
  if (format == info_formats().end()) return invalid("InfoFormat", takes, *name);
  return info_of(*parts, *pairs["I"], *pairs["J"], *format, request);
}

Result<WmtsRequest> parse_key_values(const DocumentRequest& request) {
  const auto divided = divide(request.query, kWmtsKeys);
  if (!divided) return divided.problem();
  const KeyValuePairs& pairs = *divided;
  if (auto problem = check(pairs, "Service", "WMTS")) return std::move(*problem);
  const auto& operation = pairs["Request"];
  if (!operation || operation->empty()) {
    return missing("Request", kWmtsOperations);
  }
  if (is_equal(*operation, "GetCapabilities")) return wmts_capabilities_of(pairs);
  if (is_equal(*operation, "GetFeatureInfo")) return key_value_info(pairs, request);
  if (is_equal(*operation, "GetTile")) {
    const auto parts = parts_of(pairs);
    if (!parts) return parts.problem();
    return as_request(tile_of(*parts, request));
  }
  return invalid("Request", kWmtsOperations, *operation);
}

Problem nothing_below_wmts() {
  return {404, "There is nothing here. The capabilities are at /wmts.xml."};
}

TileParts parts_of_path(const DocumentRequest& request) {
  const auto& path = request.path;
  return {path[1], path[2], path[3], path[4], path[5], path[6], style_pairs(request.query)};
}

Result<WmtsRequest> parse_tile_path(const DocumentRequest& request) {
  constexpr std::string_view kEnding = ".png";
  TileParts parts = parts_of_path(request);
  if (!parts.column.ends_with(kEnding)) return nothing_below_wmts();
  parts.column.resize(parts.column.size() - kEnding.size());
  return as_request(tile_of(parts, request));
}

Result<WmtsRequest> parse_info_path(const DocumentRequest& request) {
  const std::string& file = request.path[8];
  const std::size_t end = std::min(file.rfind('.'), file.size());
  const std::string_view ending = std::string_view(file).substr(end);
  const auto format = std::ranges::find_if(info_formats(), [ending](const InfoFormat& known) {
    return !ending.empty() && known.ending == ending;
  });
  if (format == info_formats().end()) return nothing_below_wmts();
  return info_of(parts_of_path(request), file.substr(0, end), request.path[7], *format, request);
}

}  // namespace

double wmts_margin(const ServedLayer& layer, const StyleBook& styles) {
  double margin = margin_of(StyleQuery(), layer.config);
  for (const std::string& name : styles.names()) {
    const auto style = styles.find(name);
    if (style != nullptr) margin = std::max(margin, margin_of(*style, layer.config));
  }
  return margin;
}

TileLimits wmts_limits(const ServedLayer& layer, const TileMatrixSet& set, std::size_t matrix,
                       double margin) {
  return set.limits_of(layer.layer->bounds(), matrix, margin);
}

std::vector<TileMatrixSetPtr> wmts_sets(const DocumentRequest& request) {
  std::vector<TileMatrixSetPtr> sets = request.sets.of(request.dataset);
  std::erase_if(sets, [](const TileMatrixSetPtr& set) { return !set->is_from_north(); });
  return sets;
}

bool has_tiles_of(const ServedLayer& layer, const TileMatrix& matrix) {
  const double zoom = matrix.zoom();
  return zoom >= layer.config.min_zoom && std::floor(zoom) <= layer.config.max_zoom;
}

Result<WmtsRequest> parse_wmts_request(const DocumentRequest& request) {
  const auto& path = request.path;
  if (path.size() == 1) {
    if (path[0] == "wmts") return parse_key_values(request);
    return WmtsRequest(WmtsCapabilitiesRequest{});
  }
  if (path[0] != "wmts") return nothing_below_wmts();
  if (path.size() == 3 && path[1] == kWmtsVersion && path[2] == "WMTSCapabilities.xml") {
    return WmtsRequest(WmtsCapabilitiesRequest{});
  }
  if (path.size() == 7) return parse_tile_path(request);
  if (path.size() == 9) return parse_info_path(request);
  return nothing_below_wmts();
}

bool is_wmts_key_value_path(std::string_view path) {
  return path == "/wmts";
}

}  // namespace trapeze
