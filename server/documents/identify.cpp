#include "server/documents/identify.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "core/io/source/target_grid.h"
#include "core/layer/features_at.h"
#include "core/layer/part_at.h"
#include "render/mask/mask.h"
#include "server/base/json_text.h"
#include "server/base/xml_text.h"
#include "server/data/layer_summary.h"
#include "server/data/title_attribute.h"
#include "server/documents/place_text.h"
#include "server/tiles/layer_style.h"
#include "server/tiles/tile_plan.h"
#include "server/tiles/tile_request.h"

namespace trapeze {
namespace {

constexpr std::array<std::string_view, 1> kIdentifyParameters = {"z"};
constexpr std::string_view kIdentifyPattern = "/identify/{layers}/{lon},{lat}";

constexpr std::array kInfoFormats = {
    InfoFormat{"application/geo+json", ".json", "application/geo+json", IdentifyFormat::json},
    InfoFormat{"application/json", "", "application/json", IdentifyFormat::json},
    InfoFormat{"text/plain", ".txt", "text/plain; charset=utf-8", IdentifyFormat::text},
    InfoFormat{"text/html", ".html", "text/html; charset=utf-8", IdentifyFormat::html},
};

Result<Point> place_in(const std::string& text) {
  if (const auto place = parse_place(text)) return *place;
  const std::string takes = fmt::format(
      "longitude and latitude in degrees: -180 to 180, -{0:.5f} to {0:.5f}", kMaxLatitude);
  return Problem{400, fmt::format("The path ends with {}: {}.", takes, kIdentifyPattern), "lon,lat",
                 text, takes};
}

Result<std::optional<double>> parse_zoom(const DocumentRequest& request) {
  const std::string* text = request.find("z");
  if (text == nullptr) return std::optional<double>();
  if (const auto zoom = parse_number(*text, 0, kMaxZoom)) return zoom;
  const std::string takes = fmt::format("a number from 0 to {}", kMaxZoom);
  return Problem{400, fmt::format("The parameter z takes {}.", takes), "z", *text, takes};
}

Result<PlaceQuery> parse_request(const DocumentRequest& request) {
  if (request.path.size() != 3) {
    return Problem{404,
                   fmt::format("There is nothing here. Features are at {}.", kIdentifyPattern)};
  }
  auto layers = parse_layer_list(request.path[1]);
  if (!layers) return std::move(layers).problem();
  auto place = place_in(request.path[2]);
  if (!place) return std::move(place).problem();
  auto zoom = parse_zoom(request);
  if (!zoom) return std::move(zoom).problem();
  PlaceQuery parsed{*std::move(layers), *place, *zoom, {}};
  auto style = request.style_for(parsed.layers, kIdentifyParameters);
  if (!style) return std::move(style).problem();
  parsed.style = *std::move(style);
  return parsed;
}

Level level_of(const PlaceQuery& request, const StyleQuery& style, const ServedLayer& layer) {
  if (!request.zoom) return 0;
  return nearest_level(tolerance_in_pixels(style, layer) * request.system->cells_at(*request.zoom));
}

bool is_drawn(const PlaceQuery& request, const LayerConfig& config) {
  return !request.zoom ||
         (*request.zoom >= config.min_zoom && std::floor(*request.zoom) <= config.max_zoom);
}

/// The size of a text in JSON, without quotes; invalid UTF-8 may become slightly longer.
std::size_t json_size(std::string_view text) {
  std::size_t size = text.size();
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20) size += 5;  // \u001f
    if (c == '"' || c == '\\') ++size;
  }
  return size;
}

/// The approximate size of the attributes in the answer, in bytes.
std::size_t size_of_properties(const FeatureTable& features, std::uint32_t row) {
  constexpr std::size_t kAroundValue = 32;  // indentation, quotes, a number
  std::size_t size = 0;
  for (std::size_t field = 0; field < features.fields().size(); ++field) {
    size += kAroundValue + json_size(features.fields()[field].name);
    const Value value = features.value(row, static_cast<int>(field));
    if (const auto* text = std::get_if<std::string_view>(&value)) size += json_size(*text);
  }
  return size;
}

Json properties_json(const FeatureTable& features, std::uint32_t row) {
  Json properties = Json::object();
  for (std::size_t field = 0; field < features.fields().size(); ++field) {
    properties[features.fields()[field].name] =
        to_json(features.value(row, static_cast<int>(field)));
  }
  return properties;
}

/// The features of an answer.
class IdentifiedFeatures {
 public:
  explicit IdentifiedFeatures(const PlaceQuery& query)
      : place_(query.place), system_(query.system) {}

  void add(const ServedLayer& served, const Layer& layer, std::uint32_t row) {
    if (++matched_ > kMaxIdentified) return;
    const std::size_t size = size_of_properties(layer.features(), row);
    const bool is_too_much = size > bytes_left_;
    if (is_too_much) {
      ++left_out_;
    } else {
      bytes_left_ -= size;
    }
    features_.push_back(feature_json(served, layer, row, !is_too_much));
  }

  Json take_json() {
    Json json;
    json["type"] = "FeatureCollection";
    json["numberMatched"] = matched_;
    json["numberReturned"] = features_.size();
    if (left_out_ > 0) json["propertiesLeftOut"] = left_out_;
    json["features"] = std::move(features_);
    return json;
  }

 private:
  Json feature_json(const ServedLayer& served, const Layer& layer, std::uint32_t row,
                    bool has_properties) const;
  void add_bounds(Json& json, const Layer& layer, std::uint32_t row) const;

  Point place_;
  MapSystemPtr system_;
  Json features_ = Json::array();
  std::size_t matched_ = 0;
  std::size_t left_out_ = 0;
  std::size_t bytes_left_ = kMaxIdentifiedBytes;
};

/// The bounds of all points of an outline; nothing if PROJ cannot compute them, or if there may be
/// a pole inside the outline, which the points do not show.
std::optional<GeographicBounds> bounds_from_grid(const Rings& outline, const std::string& grid) {
  std::vector<double> x;
  std::vector<double> y;
  for (const Point p : outline.points) {
    x.push_back(p.x);
    y.push_back(p.y);
  }
  const auto target = find_target_grid(grid);
  if (x.empty() || target->goes_around()) return std::nullopt;
  GridTransform transform(*target);
  if (!transform.to_lonlat(x, y)) return std::nullopt;
  const auto [west, east] = std::ranges::minmax(x);
  const auto [south, north] = std::ranges::minmax(y);
  return GeographicBounds{round_degrees(west), round_degrees(south), round_degrees(east),
                          round_degrees(north)};
}

void IdentifiedFeatures::add_bounds(Json& json, const Layer& layer, std::uint32_t row) const {
  Rings outline;
  layer.append_outline(row, outline);
  Box box;
  for (const Point p : outline.points) box.include(p);
  if (!system_->grid.empty()) {
    if (const auto bounds = bounds_from_grid(outline, system_->grid)) json["bbox"] = *bounds;
    return;
  }
  json["bbox"] = bounds_in_degrees(box);
  const Box part = part_at(outline, place_);
  if (part != box) json["part_bbox"] = bounds_in_degrees(part);
}

Json IdentifiedFeatures::feature_json(const ServedLayer& served, const Layer& layer,
                                      std::uint32_t row, bool has_properties) const {
  const FeatureTable& features = layer.features();
  Json json;
  json["type"] = "Feature";
  json["id"] = features.id(row);
  json["layer"] = served.config.name;
  if (has_properties) {
    const std::string title =
        title_of(features, title_field(features, served.config.title_attribute), row);
    if (!title.empty()) json["title"] = title;
  }
  add_bounds(json, layer, row);
  json["geometry"] = nullptr;
  json["properties"] = has_properties ? properties_json(features, row) : Json();
  return json;
}

/// A feature of a layer, or of a part of one.
struct FoundFeature {
  std::shared_ptr<const Layer> layer;
  std::uint32_t row = 0;
};

/// The layer, or the parts of it that may have a feature there. The problem, 503, is a part that
/// cannot be opened.
Result<std::vector<std::shared_ptr<const Layer>>> layers_at(Point place,
                                                            const ServedLayer& served) {
  if (served.parts == nullptr) return std::vector{served.layer};
  std::vector<std::shared_ptr<const Layer>> layers;
  for (const auto& part : served.parts->parts()) {
    const Box& box = part->summary().bounds;
    if (!box.intersects({place.x, place.y, place.x, place.y})) continue;
    layers.push_back(part->layer());
    if (layers.back() == nullptr) return damaged_layer(served);
  }
  return layers;
}

/// The features found, the topmost first, or what is wrong with the style.
Result<std::vector<FoundFeature>> find_features(const PlaceQuery& request,
                                                const ServedLayer& served, std::size_t position) {
  const auto query = complete_style(request.style, served.config);
  if (!query) return query.problem();
  const auto style = layer_style(*query, served, position);
  if (!style) return style.problem();
  std::vector<FoundFeature> found;
  if (!is_drawn(request, served.config)) return found;
  const auto layers = layers_at(request.place, served);
  if (!layers) return layers.problem();
  for (const auto& layer : *layers) {
    const Classing classing = style->classing.over(layer->features());
    const FeatureClassifier classifier(classing, layer->features());
    // Features are painted in the order of rows. Those of different parts do not overlap.
    auto rows = features_at(*layer, request.place, level_of(request, *query, served));
    std::ranges::reverse(rows);
    for (const std::uint32_t row : rows) {
      if (classifier.class_of(row) != kNotDrawn) found.push_back({layer, row});
    }
  }
  return found;
}

Result<Json> identify(const PlaceQuery& query, const Dataset& dataset) {
  IdentifiedFeatures features(query);
  for (auto name = query.layers.rbegin(); name != query.layers.rend(); ++name) {
    const auto position = dataset.find(*name);
    if (!position) return unknown_layer(*name, dataset);
    const ServedLayer* of_system = served_in(dataset, *name, *query.system);
    if (of_system == nullptr) return not_built(*name, *query.system, dataset);
    const ServedLayer& served = *of_system;
    if (!served.is_whole()) return damaged_layer(served);
    const auto found = find_features(query, served, *position);
    if (!found) return found.problem();
    const std::size_t count = std::min(found->size(), query.most_of_layer);
    for (const FoundFeature& feature : std::span(*found).first(count)) {
      features.add(served, *feature.layer, feature.row);
    }
  }
  return features.take_json();
}

constexpr std::string_view kNothing = "There is nothing here.";

std::string value_words(const Json& value) {
  if (value.is_null()) return {};
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// "Lac Léman", or "water 7" for a feature without a title.
std::string heading_of(const Json& feature) {
  if (feature.contains("title")) return value_words(feature["title"]);
  return fmt::format("{} {}", value_words(feature["layer"]), value_words(feature["id"]));
}

std::string text_of(const Json& collection) {
  std::string text;
  for (const Json& feature : collection["features"]) {
    if (!text.empty()) text += '\n';
    text += fmt::format("{}\n  layer = {}\n  id = {}\n", heading_of(feature),
                        value_words(feature["layer"]), value_words(feature["id"]));
    for (const auto& [name, value] : feature["properties"].items()) {
      text += fmt::format("  {} = {}\n", name, value_words(value));
    }
  }
  return text.empty() ? fmt::format("{}\n", kNothing) : text;
}

std::string table_row(std::string_view name, const Json& value) {
  return fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", xml_escape(name),
                     xml_escape(value_words(value)));
}

std::string html_of(const Json& collection) {
  std::string tables;
  for (const Json& feature : collection["features"]) {
    tables += fmt::format("<table>\n<caption>{}</caption>\n", xml_escape(heading_of(feature)));
    tables += table_row("layer", feature["layer"]) + table_row("id", feature["id"]);
    for (const auto& [name, value] : feature["properties"].items()) {
      tables += table_row(name, value);
    }
    tables += "</table>\n";
  }
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\">"
      "<title>Features</title></head>\n<body>\n{}</body>\n</html>\n",
      tables.empty() ? fmt::format("<p>{}</p>\n", kNothing) : tables);
}

}  // namespace

std::span<const InfoFormat> info_formats() {
  return kInfoFormats;
}

Result<std::string> identified_features(const PlaceQuery& query, const Dataset& dataset,
                                        IdentifyFormat format) {
  const auto json = identify(query, dataset);
  if (!json) return json.problem();
  if (format == IdentifyFormat::text) return text_of(*json);
  return format == IdentifyFormat::html ? html_of(*json) : to_text(*json);
}

Result<Document> identify_document(const DocumentRequest& request) {
  const auto parsed = parse_request(request);
  if (!parsed) return parsed.problem();
  auto json = identified_features(*parsed, request.dataset, IdentifyFormat::json);
  if (!json) return std::move(json).problem();
  return Document{"application/geo+json", *std::move(json)};
}

}  // namespace trapeze
