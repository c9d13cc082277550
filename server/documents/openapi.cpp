#include "server/documents/openapi.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/grid/web_mercator.h"
#include "render/mask/mask.h"
#include "server/base/build_id.h"
#include "server/base/json_text.h"
#include "server/documents/routes.h"
#include "server/styles/style_parameters.h"
#include "server/tiles/tile_matrix_set.h"
#include "server/tiles/tile_request.h"

namespace trapeze {
namespace {

Json list_schema(Json items, std::size_t max_items) {
  return {{"type", "array"}, {"items", std::move(items)}, {"maxItems", max_items}};
}

Json number_schema(const StyleParameter& parameter) {
  return {{"type", "number"}, {"minimum", parameter.min}, {"maximum", parameter.max}};
}

Json schema_of(const StyleParameter& parameter) {
  switch (parameter.type) {
    case ParameterType::number:
      return number_schema(parameter);
    case ParameterType::numbers:
      return list_schema(number_schema(parameter), parameter.max_items);
    case ParameterType::word:
      return {{"type", "string"}, {"enum", Json(parameter.words)}};
    case ParameterType::words:
      return list_schema({{"type", "string"}, {"enum", Json(parameter.words)}},
                         parameter.words.size());
    case ParameterType::ids:
      return list_schema({{"type", "integer"}, {"format", "int64"}}, parameter.max_items);
    case ParameterType::filter:
      return {{"type", "string"}, {"maxLength", kMaxFilterLength}};
    case ParameterType::colour:
    case ParameterType::name:
    case ParameterType::ramp:
    case ParameterType::classes:
    case ParameterType::style:
    case ParameterType::breaks:  // comma-separated numbers, or a rule
    case ParameterType::format:
    case ParameterType::table:
    case ParameterType::font:
    case ParameterType::language:
      return {{"type", "string"}};
    case ParameterType::text:
    case ParameterType::label:
      return {{"type", "string"}, {"maxLength", parameter.max_items}};
  }
  return Json::object();
}

Json parameter_json(const StyleParameter& parameter) {
  std::string description = fmt::format("{}. Value: {}. Default: {}.", parameter.description,
                                        describe_values(parameter), parameter.default_text);
  if (parameter.is_per_layer) {
    description +=
        fmt::format(" With several layers, LAYER.{} sets it for one of them.", parameter.name);
  }
  Json schema = schema_of(parameter);
  const bool is_list = schema["type"] == "array";
  Json json = {{"name", parameter.name},
               {"in", "query"},
               {"description", description},
               {"schema", std::move(schema)}};
  if (is_list) {
    json["style"] = "form";
    json["explode"] = false;
  }
  return json;
}

Json path_parameter(std::string_view name, std::string_view description, Json schema) {
  return {{"name", name},
          {"in", "path"},
          {"required", true},
          {"description", description},
          {"schema", std::move(schema)}};
}

Json index_schema() {
  return {{"type", "integer"}, {"minimum", 0}};
}

Json zoom_schema() {
  return {{"type", "integer"}, {"minimum", 0}, {"maximum", kMaxZoom}};
}

Json ids_of_sets(const DocumentRequest& request) {
  Json ids = Json::array();
  for (const TileMatrixSetPtr& set : request.sets.of(request.dataset)) ids.push_back(set->id);
  return ids;
}

Json names_of_systems(const DocumentRequest& request) {
  Json names = Json::array();
  for (const MapSystemPtr& system : map_systems_of(request.dataset)) names.push_back(system->name);
  return names;
}

Json uris_of_systems(const DocumentRequest& request) {
  Json uris = Json::array();
  for (const MapSystemPtr& system : map_systems_of(request.dataset)) uris.push_back(system->uri);
  return uris;
}

/// Everything that paths refer to, under the names used by reference().
Json components_json(const DocumentRequest& request) {
  Json parameters;
  for (const StyleParameter& parameter : style_parameters()) {
    parameters[std::string(parameter.name)] = parameter_json(parameter);
  }
  parameters["path-layers"] =
      path_parameter("layers",
                     fmt::format("1 to {} layer names, separated by commas, the bottom layer first",
                                 kMaxLayersPerTile),
                     {{"type", "string"}});
  parameters["path-style"] =
      path_parameter("style", "Name of a style, or id of a posted one", {{"type", "string"}});
  parameters["path-z"] = path_parameter("z", "Zoom", zoom_schema());
  parameters["path-x"] = path_parameter("x", "Column, from the west", index_schema());
  parameters["path-y"] = path_parameter("y", "Row, from the north", index_schema());
  parameters["path-collectionId"] =
      path_parameter("collectionId", "Name of a layer", {{"type", "string"}});
  parameters["path-tileMatrixSetId"] = path_parameter(
      "tileMatrixSetId", "Tile matrix set", {{"type", "string"}, {"enum", ids_of_sets(request)}});
  parameters["path-tileMatrix"] =
      path_parameter("tileMatrix", "Matrix of the set", {{"type", "string"}});
  parameters["path-tileRow"] = path_parameter("tileRow", "Row, from the north", index_schema());
  parameters["path-tileCol"] = path_parameter("tileCol", "Column, from the west", index_schema());
  for (const auto& [name, words] :
       {std::pair("path-j", "Row of pixels in the tile, from the north"),
        std::pair("path-i", "Column of pixels, from the west")}) {
    parameters[name] =
        path_parameter(std::string_view(name).substr(5), words,
                       {{"type", "integer"}, {"minimum", 0}, {"maximum", kTilePixels - 1}});
  }
  parameters["path-place"] = path_parameter(
      "place", "Longitude and latitude in degrees, with a comma between", {{"type", "string"}});
  parameters["path-table"] =
      path_parameter("table", "Name of a value table, or id of a posted one", {{"type", "string"}});
  parameters["path-layer"] = path_parameter("layer", "Name of a layer", {{"type", "string"}});
  parameters["path-attribute"] =
      path_parameter("attribute", "Name of an attribute of the layer", {{"type", "string"}});
  parameters["bbox"] = {
      {"name", "bbox"},
      {"in", "query"},
      {"description", "West, south, east, north in degrees: only features there. Default: all"},
      {"style", "form"},
      {"explode", false},
      {"schema",
       {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 4}, {"maxItems", 4}}}};
  parameters["path-centre"] =
      path_parameter("centre", "Longitude and latitude in degrees, and zoom, with commas between",
                     {{"type", "string"}});
  parameters["path-size"] =
      path_parameter("size", "Width and height in pixels, such as 640x480", {{"type", "string"}});
  parameters["window"] = {
      {"name", "bbox"},
      {"in", "query"},
      {"required", true},
      {"description",
       "West, south, east, north in degrees, or in crs; if west is greater than east, the box "
       "crosses the antimeridian"},
      {"style", "form"},
      {"explode", false},
      {"schema",
       {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 4}, {"maxItems", 4}}}};
  parameters["window-crs"] = {
      {"name", "crs"},
      {"in", "query"},
      {"description",
       "The reference system of the map and of bbox, eastings first. Default: the map in "
       "EPSG:3857, bbox in degrees"},
      {"schema", {{"type", "string"}, {"enum", names_of_systems(request)}}}};
  parameters["map-bbox"] = {
      {"name", "bbox"},
      {"in", "query"},
      {"description", "West, south, east, north in degrees, or in bbox-crs. Default: all"},
      {"style", "form"},
      {"explode", false},
      {"schema",
       {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 4}, {"maxItems", 4}}}};
  parameters["bbox-crs"] = {
      {"name", "bbox-crs"},
      {"in", "query"},
      {"description", "What bbox is in"},
      {"schema", {{"type", "string"}, {"format", "uri"}, {"enum", uris_of_systems(request)}}}};
  parameters["map-crs"] = {
      {"name", "crs"},
      {"in", "query"},
      {"description", "The reference system of the map"},
      {"schema", {{"type", "string"}, {"format", "uri"}, {"enum", uris_of_systems(request)}}}};
  parameters["bgcolor"] = {{"name", "bgcolor"},
                           {"in", "query"},
                           {"description", "The background, such as 0xFFFFFF"},
                           {"schema", {{"type", "string"}}}};
  parameters["transparent"] = {
      {"name", "transparent"},
      {"in", "query"},
      {"description",
       "Whether the background is transparent. Default: true, unless bgcolor is given"},
      {"schema", {{"type", "boolean"}}}};
  parameters["map-f"] = {{"name", "f"},
                         {"in", "query"},
                         {"description", "The format of the map"},
                         {"schema", {{"type", "string"}, {"enum", {"png", "webp"}}}}};
  for (const std::string side : {"width", "height"}) {
    parameters[side] = {
        {"name", side},
        {"in", "query"},
        {"description", "In pixels. Default: derived from bbox"},
        {"schema", {{"type", "integer"}, {"minimum", 1}, {"maximum", kMaxPicturePixels}}}};
  }
  parameters["z"] = {{"name", "z"},
                     {"in", "query"},
                     {"description", "Zoom whose polygons are used. Default: full detail"},
                     {"schema", {{"type", "number"}, {"minimum", 0}, {"maximum", kMaxZoom}}}};
  for (const auto& [name, description] :
       {std::pair("key", "The column with the keys. Default: the first"),
        std::pair("value", "The column with the values. Default: the second"),
        std::pair("layer", "The layer to join. Default: all that have the attribute"),
        std::pair(
            "join",
            "The attribute with the keys. Default: the one with the name of the key column")}) {
    parameters[fmt::format("table-{}", name)] = {{"name", name},
                                                 {"in", "query"},
                                                 {"description", description},
                                                 {"schema", {{"type", "string"}}}};
  }
  parameters["collections"] = {{"name", "collections"},
                               {"in", "query"},
                               {"description", "Layer names, the bottom layer first. Default: all"},
                               {"style", "form"},
                               {"explode", false},
                               {"schema", {{"type", "array"}, {"items", {{"type", "string"}}}}}};
  const Json problem = {{"type", "object"},
                        {"required", {"title", "status", "detail"}},
                        {"properties",
                         {{"type", {{"type", "string"}}},
                          {"title", {{"type", "string"}}},
                          {"status", {{"type", "integer"}}},
                          {"detail", {{"type", "string"}}},
                          {"parameter", {{"type", "string"}, {"description", "What is wrong"}}},
                          {"value", {{"type", "string"}, {"description", "What it was set to"}}},
                          {"takes", {{"type", "string"}, {"description", "What it takes"}}}}}};
  return {{"schemas", {{"problem", problem}}}, {"parameters", parameters}};
}

Json reference(std::string_view parameter) {
  return {{"$ref", fmt::format("#/components/parameters/{}", parameter)}};
}

Json response(std::string_view description, std::string_view type) {
  Json schema = {{"type", "object"}};
  if (type.starts_with("text/")) schema = {{"type", "string"}};
  if (type.starts_with("image/")) schema = {{"type", "string"}, {"format", "binary"}};
  return {{"description", description}, {"content", {{type, {{"schema", schema}}}}}};
}

/// The names in braces in a path.
std::vector<std::string> names_in(std::string_view path) {
  std::vector<std::string> names;
  while (true) {
    const std::size_t begin = path.find('{');
    if (begin == std::string_view::npos) return names;
    const std::size_t end = path.find('}', begin);
    names.emplace_back(path.substr(begin + 1, end - begin - 1));
    path.remove_prefix(end);
  }
}

/// Splits at spaces.
std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    words.push_back(word);
    text.remove_prefix(std::min(word.size() + 1, text.size()));
  }
  return words;
}

Json parameters_of(const Route& route) {
  Json list = Json::array();
  for (const std::string& name : names_in(route.path)) list.push_back(reference("path-" + name));
  for (const std::string_view name : words_of(route.query)) list.push_back(reference(name));
  if (!route.has_style) return list;
  for (const StyleParameter& parameter : style_parameters()) {
    list.push_back(reference(parameter.name));
  }
  return list;
}

/// The body of a POST request: a style, as JSON.
Json style_body_json() {
  Json properties;
  for (const StyleParameter& parameter : style_parameters()) {
    if (parameter.id == ParameterId::style) continue;
    properties[std::string(parameter.name)] = {{"description", parameter.description}};
  }
  Json body = {{"required", true}};
  body["content"]["application/json"]["schema"] = {{"type", "object"},
                                                   {"properties", std::move(properties)}};
  return body;
}

Json problem_response_json() {
  Json problem = response("What is wrong, in words", "application/problem+json");
  problem["content"]["application/problem+json"]["schema"] = {
      {"$ref", "#/components/schemas/problem"}};
  return problem;
}

Json problem_of(const Route& route) {
  if (area_of(route.path) != Area::wmts) return problem_response_json();
  return response("The error, as an ows:ExceptionReport", "application/xml");
}

Json get_json(const Route& route) {
  const Json problem = problem_of(route);
  const Json parameters = parameters_of(route);
  Json responses;
  responses["200"] = response(route.summary, route.content_type);
  if (!parameters.empty()) {
    responses["400"] = problem;
    responses["404"] = problem;
  }
  responses["429"] = problem;
  responses["503"] = problem;
  Json get = {{"operationId", route.operation}, {"summary", route.summary}};
  if (!parameters.empty()) get["parameters"] = parameters;
  get["responses"] = responses;
  return get;
}

/// The body of a POST request: a table of keys and values.
Json table_body_json() {
  Json body = {{"required", true}};
  body["content"]["text/csv"]["schema"] = {{"type", "string"}};
  // OpenAPI 3.0 has no type for a choice of two.
  body["content"]["application/json"]["schema"] = {
      {"oneOf", {{{"type", "array"}, {"items", Json::object()}}, {{"type", "object"}}}}};
  return body;
}

Json post_json(const Route& route) {
  const bool is_table = route.id == RouteId::post_values;
  Json post = {{"operationId", route.operation},
               {"summary", route.summary},
               {"requestBody", is_table ? table_body_json() : style_body_json()}};
  if (is_table) post["parameters"] = parameters_of(route);
  post["responses"] = {
      {"201", response(is_table ? "The id of the table, and how it matches the layers"
                                : "The id of the style",
                       route.content_type)},
      {"400", problem_response_json()},
      {"403", problem_response_json()},
      {"413", problem_response_json()},
      {"429", problem_response_json()}};
  if (is_table) {
    for (const char* status : {"415", "503"}) post["responses"][status] = problem_response_json();
  }
  return post;
}

}  // namespace

std::string openapi_json(const DocumentRequest& request) {
  Json paths;
  for (const Route& route : routes()) {
    if (route.operation.empty()) continue;
    Json& methods = paths[std::string(route.path)];
    if (route.method == "POST") {
      methods["post"] = post_json(route);
    } else {
      methods["get"] = get_json(route);
    }
  }
  Json json;
  json["openapi"] = "3.0.3";
  json["info"] = {{"title", "Trapeze"},
                  {"version", version()},
                  {"description", "Polygon maps as tiles, simplified while they are drawn"},
                  {"license", {{"name", "MIT"}}}};
  json["servers"] = Json::array({{{"url", request.base_url}}});
  json["paths"] = paths;
  json["components"] = components_json(request);
  return to_text(json);
}

}  // namespace trapeze
