#include "server/documents/openapi.h"

#include <spdlog/fmt/fmt.h>

#include <string_view>
#include <vector>

#include "core/grid/web_mercator.h"
#include "server/base/build_id.h"
#include "server/base/json_text.h"
#include "server/documents/tile_matrix_set.h"
#include "server/styles/style_parameters.h"
#include "server/tiles/tile_request.h"

namespace trapeze {
namespace {

Json words_json(std::string_view words) {
  Json list = Json::array();
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    list.push_back(words.substr(0, end));
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return list;
}

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
    case ParameterType::ascending:
      return list_schema(number_schema(parameter), parameter.max_items);
    case ParameterType::word:
      return {{"type", "string"}, {"enum", words_json(parameter.words)}};
    case ParameterType::words:
      return list_schema({{"type", "string"}, {"enum", words_json(parameter.words)}},
                         words_json(parameter.words).size());
    case ParameterType::ids:
      return list_schema({{"type", "integer"}, {"format", "int64"}}, parameter.max_items);
    case ParameterType::filter:
      return {{"type", "string"}, {"maxLength", kMaxFilterLength}};
    case ParameterType::colour:
    case ParameterType::name:
    case ParameterType::ramp:
    case ParameterType::classes:
    case ParameterType::style:
      return {{"type", "string"}};
  }
  return Json::object();
}

Json parameter_json(const StyleParameter& parameter) {
  std::string description = fmt::format("{}. Takes {}. Without it: {}.", parameter.description,
                                        describe_values(parameter), parameter.default_text);
  if (parameter.is_per_layer) {
    description += fmt::format(" Of several layers, LAYER.{} sets it for one.", parameter.name);
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

/// All that paths refer to, by the names that reference() takes.
Json components_json() {
  Json parameters;
  for (const StyleParameter& parameter : style_parameters()) {
    parameters[std::string(parameter.name)] = parameter_json(parameter);
  }
  parameters["path-layers"] =
      path_parameter("layers",
                     fmt::format("1 to {} names of layers, separated by commas, the lowest first",
                                 kMaxLayersPerTile),
                     {{"type", "string"}});
  parameters["path-style"] = path_parameter(
      "style", "Name of a style, or the id of one that was posted", {{"type", "string"}});
  parameters["path-z"] = path_parameter("z", "Zoom", zoom_schema());
  parameters["path-x"] = path_parameter("x", "Column, from the west", index_schema());
  parameters["path-y"] = path_parameter("y", "Row, from the north", index_schema());
  parameters["path-collectionId"] =
      path_parameter("collectionId", "Name of a layer", {{"type", "string"}});
  parameters["path-tileMatrixSetId"] =
      path_parameter("tileMatrixSetId", "Tile matrix set",
                     {{"type", "string"}, {"enum", Json::array({kTileMatrixSet})}});
  parameters["path-tileMatrix"] = path_parameter("tileMatrix", "Zoom", zoom_schema());
  parameters["path-tileRow"] = path_parameter("tileRow", "Row, from the north", index_schema());
  parameters["path-tileCol"] = path_parameter("tileCol", "Column, from the west", index_schema());
  parameters["path-place"] = path_parameter(
      "place", "Longitude and latitude in degrees, with a comma between", {{"type", "string"}});
  parameters["z"] = {
      {"name", "z"},
      {"in", "query"},
      {"description", "Zoom at which the polygons are looked at; without it: at full detail"},
      {"schema", {{"type", "number"}, {"minimum", 0}, {"maximum", kMaxZoom}}}};
  parameters["collections"] = {
      {"name", "collections"},
      {"in", "query"},
      {"description", "Names of layers, the lowest first; without it: all"},
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

Json references(std::initializer_list<std::string_view> names) {
  Json list = Json::array();
  for (const std::string_view name : names) list.push_back(reference(name));
  return list;
}

Json with_style(Json list) {
  for (const StyleParameter& parameter : style_parameters()) {
    list.push_back(reference(parameter.name));
  }
  return list;
}

Json response(std::string_view description, std::string_view type) {
  Json schema = {{"type", "object"}};
  if (type.starts_with("image/")) schema = {{"type", "string"}, {"format", "binary"}};
  return {{"description", description}, {"content", {{type, {{"schema", schema}}}}}};
}

struct Operation {
  std::string_view path;
  std::string_view id;
  std::string_view summary;
  std::string_view type;  // of the response
  Json parameters;
};

Json operation_json(const Operation& operation) {
  Json problem = response("What is wrong, in words", "application/problem+json");
  problem["content"]["application/problem+json"]["schema"] = {
      {"$ref", "#/components/schemas/problem"}};
  Json responses;
  responses["200"] = response(operation.summary, operation.type);
  if (!operation.parameters.empty()) {
    responses["400"] = problem;
    responses["404"] = problem;
  }
  responses["429"] = problem;
  responses["503"] = problem;
  Json get = {{"operationId", operation.id}, {"summary", operation.summary}};
  if (!operation.parameters.empty()) get["parameters"] = operation.parameters;
  get["responses"] = responses;
  return {{"get", get}};
}

std::vector<Operation> operations() {
  constexpr std::string_view kJson = "application/json";
  constexpr std::string_view kPng = "image/png";
  return {
      {"/tiles/{layers}/{z}/{x}/{y}.png", "getTile", "A tile of 256 pixels", kPng,
       with_style(references({"path-layers", "path-z", "path-x", "path-y"}))},
      {"/tiles/{layers}/{z}/{x}/{y}@2x.png", "getTile2x", "A tile of 512 pixels", kPng,
       with_style(references({"path-layers", "path-z", "path-x", "path-y"}))},
      {"/tiles/{layers}/{z}/{x}/{y}.webp", "getWebpTile", "A tile of 256 pixels, as WebP",
       "image/webp", with_style(references({"path-layers", "path-z", "path-x", "path-y"}))},
      {"/tiles/{layers}/s/{style}/{z}/{x}/{y}.png", "getStyledTile",
       "A tile in a style of the configuration, or one that was posted", kPng,
       references({"path-layers", "path-style", "path-z", "path-x", "path-y"})},
      {"/styles", "getStyles", "The names of styles", kJson, Json::array()},
      {"/styles/{style}", "getStyle", "A style, by name or id", kJson, references({"path-style"})},
      {"/tiles/{layers}.json", "getTileJson", "TileJSON 3.0 of layers", kJson,
       with_style(references({"path-layers"}))},
      {"/legend/{layers}.png", "getLegendPicture", "What the colours mean, as a picture", kPng,
       with_style(references({"path-layers"}))},
      {"/legend/{layers}.json", "getLegend", "What the colours mean", kJson,
       with_style(references({"path-layers"}))},
      {"/identify/{layers}/{place}", "identify", "The features under a place",
       "application/geo+json", with_style(references({"path-layers", "path-place", "z"}))},
      {"/catalog", "getCatalog", "The layers and the parameters", kJson, Json::array()},
      {"/wmts.xml", "getWmtsCapabilities", "WMTS 1.0.0 capabilities", "application/xml",
       Json::array()},
      {"/ogc", "getLandingPage", "Landing page", kJson, Json::array()},
      {"/ogc/conformance", "getConformance", "Conformance classes", kJson, Json::array()},
      {"/ogc/api", "getApi", "This document", "application/vnd.oai.openapi+json;version=3.0",
       Json::array()},
      {"/ogc/collections", "getCollections", "The layers", kJson, Json::array()},
      {"/ogc/collections/{collectionId}", "getCollection", "A layer", kJson,
       references({"path-collectionId"})},
      {"/ogc/collections/{collectionId}/map/tiles", "trapeze.collection.map.getTileSetsList",
       "The tilesets of a layer", kJson, with_style(references({"path-collectionId"}))},
      {"/ogc/collections/{collectionId}/map/tiles/{tileMatrixSetId}",
       "trapeze.collection.map.getTileSet", "A tileset of a layer", kJson,
       with_style(references({"path-collectionId", "path-tileMatrixSetId"}))},
      {"/ogc/collections/{collectionId}/map/tiles/{tileMatrixSetId}/{tileMatrix}/{tileRow}/"
       "{tileCol}",
       "trapeze.collection.map.getTile", "A tile of a layer", kPng,
       with_style(references({"path-collectionId", "path-tileMatrixSetId", "path-tileMatrix",
                              "path-tileRow", "path-tileCol"}))},
      {"/ogc/map/tiles", "trapeze.dataset.map.getTileSetsList", "The tilesets of all layers", kJson,
       with_style(references({"collections"}))},
      {"/ogc/map/tiles/{tileMatrixSetId}", "trapeze.dataset.map.getTileSet",
       "A tileset of all layers", kJson,
       with_style(references({"path-tileMatrixSetId", "collections"}))},
      {"/ogc/map/tiles/{tileMatrixSetId}/{tileMatrix}/{tileRow}/{tileCol}",
       "trapeze.dataset.map.getTile", "A tile of all layers", kPng,
       with_style(references({"path-tileMatrixSetId", "path-tileMatrix", "path-tileRow",
                              "path-tileCol", "collections"}))},
      {"/ogc/tileMatrixSets", "getTileMatrixSetsList", "The tile matrix sets", kJson,
       Json::array()},
      {"/ogc/tileMatrixSets/{tileMatrixSetId}", "getTileMatrixSet", "A tile matrix set", kJson,
       references({"path-tileMatrixSetId"})},
  };
}

Json post_style_json() {
  Json properties;
  for (const StyleParameter& parameter : style_parameters()) {
    if (parameter.id == ParameterId::style) continue;
    properties[std::string(parameter.name)] = {{"description", parameter.description}};
  }
  Json problem = response("What is wrong, in words", "application/problem+json");
  Json body = {{"required", true}};
  body["content"]["application/json"]["schema"] = {{"type", "object"},
                                                   {"properties", std::move(properties)}};
  Json post = {{"operationId", "postStyle"},
               {"summary", "Keep a style; the id is the same for equal styles"},
               {"requestBody", std::move(body)}};
  post["responses"] = {{"201", response("The id of the style", "application/json")},
                       {"400", problem},
                       {"403", problem}};
  return post;
}

}  // namespace

std::string openapi_json(const std::string& base_url) {
  Json paths;
  for (const Operation& operation : operations()) {
    paths[std::string(operation.path)] = operation_json(operation);
  }
  paths["/styles"]["post"] = post_style_json();
  Json json;
  json["openapi"] = "3.0.3";
  json["info"] = {{"title", "Trapeze"},
                  {"version", version()},
                  {"description", "Maps of polygons as tiles, simplified while they are drawn"},
                  {"license", {{"name", "MIT"}}}};
  json["servers"] = Json::array({{{"url", base_url}}});
  json["paths"] = paths;
  json["components"] = components_json();
  return to_text(json);
}

}  // namespace trapeze
