#include "server/catalog.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/web_mercator.h"
#include "server/tile_plan.h"

namespace trapeze {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<double, 4> kWorld = {-180, -kMaxLatitude, 180, kMaxLatitude};

std::string to_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// To about a centimetre, which is what the grid resolves: shorter to read.
double round_degrees(double degrees) {
  return std::round(degrees * 1e7) / 1e7;
}

/// West, south, east, north; the box is not empty.
std::array<double, 4> bounds_in_degrees(const Box& box) {
  const LonLat north_west = lonlat_from_grid(box.min_x, box.min_y);
  const LonLat south_east = lonlat_from_grid(box.max_x, box.max_y);
  return {round_degrees(north_west.lon), round_degrees(south_east.lat),
          round_degrees(south_east.lon), round_degrees(north_west.lat)};
}

std::string_view name_of(FieldType type) {
  switch (type) {
    case FieldType::integer:
      return "integer";
    case FieldType::real:
      return "number";
    case FieldType::text:
      return "string";
  }
  return "string";
}

Json fields_json(const FeatureTable& features) {
  Json fields = Json::array();
  for (const Field& field : features.fields()) {
    fields.push_back({{"name", field.name}, {"type", name_of(field.type)}});
  }
  return fields;
}

/// The style of a layer where a request does not say otherwise, in the words of the query
/// parameters.
Json style_json(const LayerConfig& config, std::size_t position) {
  Rgba fill = default_fill(config, position);
  const double opacity = config.style.fill_opacity * fill.a / 255.0;
  fill.a = 255;
  return {{"fill", fmt::format("#{:02x}{:02x}{:02x}", fill.r, fill.g, fill.b)},
          {"fill-opacity", opacity}};
}

Json layer_json(const ServedLayer& served, std::size_t position, const std::string& base_url) {
  const LayerConfig& config = served.config;
  const Box& box = served.layer->bounds();
  Json json;
  json["name"] = config.name;
  json["title"] = config.title;
  json["attribution"] = config.attribution;
  json["description"] = config.description;
  json["bounds"] = box.is_empty() ? Json(nullptr) : Json(bounds_in_degrees(box));
  json["minzoom"] = config.min_zoom;
  json["maxzoom"] = config.max_zoom;
  json["features"] = served.report.loaded;
  json["polygons"] = served.report.polygons;
  json["rings"] = served.report.rings;
  json["vertices"] = served.report.vertices;
  json["trapezoids"] = served.layer->mesh().trapezoids.size();
  json["memory"] = served.layer->memory() + served.layer->features().memory();
  json["repaired"] = served.report.repaired;
  json["skipped"] = served.report.skipped;
  json["style"] = style_json(config, position);
  json["fields"] = fields_json(served.layer->features());
  json["tilejson"] = fmt::format("{}/tiles/{}.json", base_url, config.name);
  return json;
}

Json parameters_json() {
  Json parameters = Json::array();
  for (const StyleParameter& parameter : style_parameters()) {
    parameters.push_back({{"name", parameter.name},
                          {"takes", describe_values(parameter)},
                          {"default", parameter.default_text},
                          {"per_layer", parameter.is_per_layer},
                          {"description", parameter.description}});
  }
  return parameters;
}

/// What several layers come to when they are served as one tile set.
struct Together {
  std::vector<std::string> titles;
  std::vector<std::string> descriptions;
  std::vector<std::string> attributions;
  Box box;
  int min_zoom = kMaxZoom;
  int max_zoom = 0;
};

void add_once(std::vector<std::string>& texts, const std::string& text) {
  if (text.empty() || std::ranges::find(texts, text) != texts.end()) return;
  texts.push_back(text);
}

std::string joined(const std::vector<std::string>& texts) {
  return fmt::format("{}", fmt::join(texts, ", "));
}

void add_layer(Together& together, const ServedLayer& served) {
  add_once(together.titles, served.config.title);
  add_once(together.descriptions, served.config.description);
  add_once(together.attributions, served.config.attribution);
  together.box.include(served.layer->bounds());
  together.min_zoom = std::min(together.min_zoom, served.config.min_zoom);
  together.max_zoom = std::max(together.max_zoom, served.config.max_zoom);
}

/// Middle of the bounds, and the zoom at which their width is about that of two tiles.
Json center_json(const std::array<double, 4>& bounds, const Together& together) {
  const auto [west, south, east, north] = bounds;
  const double width = std::max(east - west, 1e-6);
  const int zoom = static_cast<int>(std::floor(std::log2(2 * 360 / width)));
  return {round_degrees((west + east) / 2), round_degrees((south + north) / 2),
          std::clamp(zoom, together.min_zoom, together.max_zoom)};
}

std::string tiles_url(const TileJsonRequest& request, const std::string& base_url) {
  const std::string style = request.style.canonical_text();
  return fmt::format("{}/tiles/{}/{{z}}/{{x}}/{{y}}.png{}{}", base_url,
                     fmt::join(request.layers, ","), style.empty() ? "" : "?", style);
}

}  // namespace

std::string catalog_json(const Dataset& dataset, const std::string& renderer,
                         const std::string& base_url) {
  Json layers = Json::array();
  for (std::size_t i = 0; i < dataset.layers().size(); ++i) {
    layers.push_back(layer_json(dataset.layers()[i], i, base_url));
  }
  Json json;
  json["layers"] = std::move(layers);
  json["generation"] = dataset.generation();
  json["renderer"] = renderer;
  json["parameters"] = parameters_json();
  return to_text(json);
}

OrProblem<std::string> tile_json(const TileJsonRequest& request, const Dataset& dataset,
                                 const std::string& base_url) {
  Together together;
  for (const std::string& name : request.layers) {
    const auto layer = dataset.find(name);
    if (!layer) return unknown_layer(name, dataset);
    add_layer(together, dataset.layers()[*layer]);
  }
  const auto bounds = together.box.is_empty() ? kWorld : bounds_in_degrees(together.box);
  Json json;
  json["tilejson"] = "3.0.0";
  json["name"] = joined(together.titles);
  json["description"] = joined(together.descriptions);
  json["attribution"] = joined(together.attributions);
  json["scheme"] = "xyz";
  json["format"] = "png";
  json["tiles"] = {tiles_url(request, base_url)};
  json["minzoom"] = together.min_zoom;
  json["maxzoom"] = together.max_zoom;
  json["bounds"] = bounds;
  json["center"] = center_json(bounds, together);
  json["vector_layers"] = Json::array();  // TileJSON 3.0 wants it always; these are pictures
  return to_text(json);
}

}  // namespace trapeze
