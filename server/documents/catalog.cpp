#include "server/documents/catalog.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include "core/grid/web_mercator.h"
#include "render/mask/mask.h"
#include "server/base/json_text.h"
#include "server/base/language_tag.h"
#include "server/data/layer_summary.h"
#include "server/data/title_attribute.h"
#include "server/documents/classification.h"
#include "server/tiles/layer_style.h"

namespace trapeze {
namespace {

Json fields_json(const FeatureTable& features) {
  Json fields = Json::array();
  for (const Field& field : features.fields()) {
    fields.push_back({{"name", field.name}, {"type", json_type_of(field.type)}});
  }
  return fields;
}

/// The default style of a layer, as query parameters.
Json style_json(const LayerConfig& config, std::size_t position) {
  Rgba fill = default_fill(config, position);
  const ParameterValue* set = config.style.find({}, ParameterId::fill_opacity);
  const double opacity = (set != nullptr ? std::get<double>(*set) : 1.0) * fill.a / 255.0;
  fill.a = 255;
  Json json = {{"fill", css_colour(fill)}, {"fill-opacity", opacity}};
  for (const auto& [name, value] : config.style.pairs()) {
    if (!json.contains(name)) json[name] = value;
  }
  return json;
}

/// The values of `topology` that the layer supports.
Json topologies_json(const ServedLayer& served) {
  Json topologies = Json::array();
  for (const std::string_view name : kTopologyNames.names()) {
    if (served.layer_for(*kTopologyNames.find(name)) != nullptr) topologies.push_back(name);
  }
  return topologies;
}

/// The parameters that requests cannot set for the layer.
Json locked_json(const LayerConfig& config) {
  Json locked = Json::array();
  for (const ParameterId parameter : config.locked) {
    locked.push_back(style_parameter(parameter).name);
  }
  return locked;
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
  if (config.detail_zoom) json["detail_zoom"] = *config.detail_zoom;
  if (!config.group.empty()) json["group"] = config.group;
  const FeatureTable& features = served.layer->features();
  if (const auto title = title_field(features, config.title_attribute)) {
    json["title_attribute"] = features.fields()[*title].name;
  }
  json["features"] = served.report.loaded;
  json["polygons"] = served.report.polygons;
  json["rings"] = served.report.rings;
  json["vertices"] = served.report.vertices;
  json["topologies"] = topologies_json(served);
  json["coverages"] = served.report.coverage.groups;
  json["trapezoids"] = served.trapezoids();
  json["memory"] = served.memory();
  if (served.merge() > 0) json["merge"] = served.merge();
  if (!config.locked.empty()) json["locked"] = locked_json(config);
  if (served.parts != nullptr) json["parts"] = served.parts->parts().size();
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

/// The centre of the bounds, or of the narrowest bounds if these cross the antimeridian, and the
/// zoom at which they are about two tiles wide.
Json center_json(const LayerSummary& summary, const LongitudeStrip& strip) {
  const auto [west, south, east, north] = summary.bounds();
  const double width = std::max(strip.east - strip.west, 1e-6);
  const int zoom = static_cast<int>(std::floor(std::log2(2 * 360 / width)));
  const double middle = (strip.west + strip.east) / 2;
  return {round_degrees(middle > 180 ? middle - 360 : middle), round_degrees((south + north) / 2),
          std::clamp(zoom, summary.min_zoom, summary.max_zoom)};
}

std::string after_path(const std::string& query) {
  return query.empty() ? query : "?" + query;
}

/// With the name of the style in the path, where no CDN drops it.
std::string tiles_url(const TileJsonRequest& request, const std::string& base_url) {
  const std::string& name = request.style.name;
  return fmt::format("{}/tiles/{}{}/{{z}}/{{x}}/{{y}}{}.png{}", base_url,
                     fmt::join(request.layers, ","), name.empty() ? name : "/s/" + name,
                     scale_suffix(request.scale), after_path(request.style.own.canonical_text()));
}

/// For layers whose numbers are classed by a rule, or that have joined values: the result, by
/// layer. The problem is one of the style.
Result<Json> classifications_of(const TileJsonRequest& request, const Dataset& dataset) {
  Json found = Json::object();
  for (const std::string& name : request.layers) {
    const std::size_t position = *dataset.find(name);
    const ServedLayer& served = dataset.layers()[position];
    const auto complete = complete_style(request.full_style, served.config);
    // Other problems are reported by the tiles.
    if (!complete || !names_values(*complete, name)) continue;
    const auto style = layer_style(*complete, served, position);
    if (!style) return style.problem();
    found[name] = classification_json(*style);
  }
  return found;
}

std::string legend_url(const TileJsonRequest& request, const std::string& base_url) {
  return fmt::format("{}/legend/{}{}.png{}", base_url, fmt::join(request.layers, ","),
                     scale_suffix(request.scale), after_path(request.style.query()));
}

/// The languages available for labels: those of configured tables, and of attributes whose name is
/// that of another one, followed by a colon and the language.
std::set<std::string> languages_of(const Dataset& dataset) {
  std::set<std::string> languages;
  for (const auto& [name, named] : dataset.tables()) {
    for (const auto& [language, table] : named.languages) languages.insert(language);
  }
  for (const ServedLayer& layer : dataset.layers()) {
    const FeatureTable& features = layer.layer->features();
    for (const Field& field : features.fields()) {
      const std::size_t colon = field.name.rfind(':');
      if (colon == std::string::npos || !is_language_tag(field.name.substr(colon + 1))) continue;
      if (features.field_index(field.name.substr(0, colon)) < 0) continue;
      languages.insert(field.name.substr(colon + 1));
    }
  }
  return languages;
}

}  // namespace

std::string_view json_type_of(FieldType type) {
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

std::string catalog_json(const Dataset& dataset, const std::string& renderer,
                         const ViewerConfig& viewer, const std::string& base_url) {
  Json layers = Json::array();
  for (std::size_t i = 0; i < dataset.layers().size(); ++i) {
    layers.push_back(layer_json(dataset.layers()[i], i, base_url));
  }
  Json json;
  json["layers"] = std::move(layers);
  json["generation"] = dataset.generation();
  json["renderer"] = renderer;
  json["parameters"] = parameters_json();
  json["languages"] = languages_of(dataset);
  json["tables"] = Json::object();
  for (const auto& [name, named] : dataset.tables()) {
    json["tables"][name] = {{"title", named.title}, {"attribution", named.attribution}};
  }
  json["viewer"] = {{"title", viewer.title}, {"start", viewer.start}};
  return to_text(json);
}

std::string attribution_of(std::string own, std::span<const std::string> layers,
                           const StyleQuery& style, const Dataset& dataset) {
  std::string text = std::move(own);
  for (const std::string& layer : layers) {
    const StyleQuery& usual = dataset.layers()[*dataset.find(layer)].config.style;
    const StyleQuery shown = style.with_defaults(layer, usual);
    const ParameterValue* value = shown.find(layer, ParameterId::values);
    const auto* choice = value == nullptr ? nullptr : std::get_if<TableChoice>(value);
    if (choice == nullptr) continue;
    for (const auto& [name, named] : dataset.tables()) {
      if (name != choice->name && named.table->id() != choice->name) continue;
      if (named.attribution.empty() || text.find(named.attribution) != std::string::npos) continue;
      text = text.empty() ? named.attribution : fmt::format("{}, {}", text, named.attribution);
    }
  }
  return text;
}

Result<std::string> tile_json(const TileJsonRequest& request, const Dataset& dataset,
                              const std::string& base_url) {
  const auto summarized = summarize_layers(request.layers, dataset);
  if (!summarized) return summarized.problem();
  const auto& summary = *summarized;
  Json json;
  json["tilejson"] = "3.0.0";
  json["name"] = summary.title;
  json["description"] = summary.description;
  json["attribution"] =
      attribution_of(summary.attribution, request.layers, request.full_style, dataset);
  const auto classified = classifications_of(request, dataset);
  if (!classified) return classified.problem();
  json["scheme"] = "xyz";
  json["format"] = "png";
  json["tiles"] = {tiles_url(request, base_url)};
  // The size of a tile in pixels of the map, at every scale: MapLibre reads it, and assumes 512
  // without it.
  json["tileSize"] = kTilePixels;
  json["minzoom"] = summary.min_zoom;
  json["maxzoom"] = summary.max_zoom;
  if (summary.detail_zoom) json["detail_zoom"] = *summary.detail_zoom;
  json["bounds"] = summary.bounds();
  json["center"] = center_json(summary, strip_around_layers(request.layers, dataset));
  json["legend"] = legend_url(request, base_url);
  if (!classified->empty()) json["classification"] = *classified;
  json["vector_layers"] = Json::array();  // required by TileJSON 3.0, though these are pictures
  return to_text(json);
}

}  // namespace trapeze
