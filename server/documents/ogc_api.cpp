#include "server/documents/ogc_api.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/grid/web_mercator.h"
#include "server/base/json_text.h"
#include "server/data/layer_summary.h"
#include "server/documents/catalog.h"
#include "server/documents/ogc_map.h"
#include "server/documents/openapi.h"
#include "server/documents/routes.h"
#include "server/tiles/tile_matrix_set.h"

namespace trapeze {
namespace {

constexpr std::array<std::string_view, 2> kOgcApiParameters = {"collections", "f"};
constexpr std::string_view kJsonType = "application/json";
constexpr std::string_view kPngType = "image/png";
constexpr std::string_view kMapRelation = "http://www.opengis.net/def/rel/ogc/1.0/map";
constexpr std::string_view kTilesetsRelation =
    "http://www.opengis.net/def/rel/ogc/1.0/tilesets-map";
constexpr std::string_view kTilingSchemeRelation =
    "http://www.opengis.net/def/rel/ogc/1.0/tiling-scheme";
constexpr std::string_view kTilingSchemesRelation =
    "http://www.opengis.net/def/rel/ogc/1.0/tiling-schemes";

// Lists only what is actually supported.
constexpr std::array<std::string_view, 20> kConformance = {
    "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/landing-page",
    "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/json",
    "http://www.opengis.net/spec/ogcapi-common-1/1.0/conf/oas30",
    "http://www.opengis.net/spec/ogcapi-common-2/1.0/conf/collections",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/tileset",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/tilesets-list",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/dataset-tilesets",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/geodata-tilesets",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/collections-selection",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/png",
    "http://www.opengis.net/spec/ogcapi-tiles-1/1.0/conf/oas30",
    "http://www.opengis.net/spec/ogcapi-maps-1/1.0/conf/core",
    "http://www.opengis.net/spec/ogcapi-maps-1/1.0/conf/dataset-map",
    "http://www.opengis.net/spec/ogcapi-maps-1/1.0/conf/collection-map",
    "http://www.opengis.net/spec/ogcapi-maps-1/1.0/conf/png",
    "http://www.opengis.net/spec/tms/2.0/conf/tilematrixset",
    "http://www.opengis.net/spec/tms/2.0/conf/json-tilematrixset",
    "http://www.opengis.net/spec/tms/2.0/conf/json-tilesetmetadata"};

Json link(std::string_view relation, std::string_view type, std::string_view title,
          const std::string& href) {
  return {{"rel", relation}, {"type", type}, {"title", title}, {"href", href}};
}

Problem nothing_below_ogc() {
  return {404, "There is nothing here. The beginning is /ogc."};
}

/// A resource below /ogc that has tiles: one collection, or the dataset with all or some of them.
struct TiledResource {
  std::string path;                 // "/collections/lakes", or empty for the dataset
  std::vector<std::string> layers;  // bottom first
  std::string selection;            // "collections=a,b" if only some were requested
};

Result<TiledResource> tiled_collection(const std::string& name, const Dataset& dataset) {
  if (!dataset.find(name)) return unknown_layer(name, dataset);
  return TiledResource{"/collections/" + name, {name}, {}};
}

Result<TiledResource> tiled_dataset(const DocumentRequest& request) {
  TiledResource resource;
  if (const std::string* selection = request.find("collections")) {
    auto layers = parse_layer_list(*selection);
    if (!layers) {
      layers.problem().parameter = "collections";
      return std::move(layers).problem();
    }
    for (const std::string& name : *layers) {
      if (request.dataset.find(name)) continue;
      Problem problem = unknown_layer(name, request.dataset);
      problem.parameter = "collections";
      return problem;
    }
    resource.layers = *std::move(layers);
    resource.selection = fmt::format("collections={}", fmt::join(resource.layers, ","));
    return resource;
  }
  for (const ServedLayer& layer : request.dataset.layers()) {
    resource.layers.push_back(layer.config.name);
  }
  if (resource.layers.size() > kMaxLayersPerTile) {
    return Problem{400,
                   fmt::format("A tile shows at most {} layers, but there are {}: select some.",
                               kMaxLayersPerTile, resource.layers.size()),
                   "collections", "", "layer names, separated by commas"};
  }
  return resource;
}

/// The query that links need after their path to keep the resource and its style.
Result<std::string> query_of(const TiledResource& resource, const DocumentRequest& request) {
  const auto style = request.style_link_for(resource.layers, kOgcApiParameters);
  if (!style) return style.problem();
  const std::string text = style->query();
  std::string query = resource.selection;
  if (!query.empty() && !text.empty()) query += '&';
  query += text;
  return query.empty() ? query : "?" + query;
}

std::string tiles_url(const DocumentRequest& request, const TiledResource& resource) {
  return fmt::format("{}/ogc{}/map/tiles", request.base_url, resource.path);
}

std::string matrix_set_url(const TileMatrixSet& set, const DocumentRequest& request) {
  return fmt::format("{}/ogc/tileMatrixSets/{}", request.base_url, set.id);
}

Json landing_page(const DocumentRequest& request) {
  const std::string root = request.base_url + "/ogc";
  Json links = Json::array();
  links.push_back(link("self", kJsonType, "This document", root));
  links.push_back(link("service-desc", kOpenApiType, "Definition of the API", root + "/api"));
  links.push_back(
      link("conformance", kJsonType, "Conformance classes of this server", root + "/conformance"));
  links.push_back(link("http://www.opengis.net/def/rel/ogc/1.0/conformance", kJsonType,
                       "Conformance classes of this server", root + "/conformance"));
  links.push_back(link("data", kJsonType, "The layers", root + "/collections"));
  links.push_back(link("http://www.opengis.net/def/rel/ogc/1.0/data", kJsonType, "The layers",
                       root + "/collections"));
  links.push_back(link(kMapRelation, kPngType, "A map of all layers together", root + "/map"));
  links.push_back(
      link(kTilesetsRelation, kJsonType, "Map tiles of all layers together", root + "/map/tiles"));
  links.push_back(
      link(kTilingSchemesRelation, kJsonType, "Tile matrix sets", root + "/tileMatrixSets"));
  return {{"title", "Trapeze"},
          {"description", "Polygon maps as tiles, simplified while they are drawn"},
          {"links", links}};
}

Json collection_json(const ServedLayer& served, const DocumentRequest& request) {
  const LayerConfig& config = served.config;
  const std::string url = fmt::format("{}/ogc/collections/{}", request.base_url, config.name);
  Json json;
  json["id"] = config.name;
  json["title"] = config.title;
  if (!config.description.empty()) json["description"] = config.description;
  const std::string attribution =
      attribution_of(config.attribution, {&config.name, 1}, StyleQuery(), request.dataset);
  if (!attribution.empty()) json["attribution"] = attribution;
  const Box& box = served.layer->bounds();
  const GeographicBounds bounds = box.is_empty() ? kWorldBounds : bounds_in_degrees(box);
  json["extent"] = {{"spatial", {{"bbox", Json::array({Json(bounds)})}, {"crs", crs84()->uri}}}};
  json["dataType"] = "map";
  json["crs"] = Json::array();
  for (const MapSystemPtr& system : map_systems_of(request.dataset, config.name)) {
    json["crs"].push_back(system->uri);
  }
  json["storageCrs"] = web_mercator()->uri;
  json["links"] =
      Json::array({link("self", kJsonType, "This layer", url),
                   link(kMapRelation, kPngType, "A map", url + "/map"),
                   link(kTilesetsRelation, kJsonType, "Map tiles", url + "/map/tiles")});
  return json;
}

Json collections_json(const DocumentRequest& request) {
  Json collections = Json::array();
  for (const ServedLayer& served : request.dataset.layers()) {
    collections.push_back(collection_json(served, request));
  }
  const Json self = link("self", kJsonType, "This document", request.base_url + "/ogc/collections");
  return {{"links", Json::array({self})}, {"collections", collections}};
}

/// The members shared by the list of tilesets and the tileset itself.
Json tileset_head(const LayerSummary& summary, const TileMatrixSet& set) {
  Json json = {{"title", summary.title}, {"dataType", "map"}, {"crs", set.system->uri}};
  if (!set.uri.empty()) json["tileMatrixSetURI"] = set.uri;
  return json;
}

/// The matrices at whose scales some layer is drawn.
std::vector<std::size_t> matrices_of(const LayerSummary& summary, const TileMatrixSet& set) {
  std::vector<std::size_t> matrices;
  for (std::size_t i = 0; i < set.matrices.size(); ++i) {
    const double zoom = set.matrices[i].zoom();
    if (zoom >= summary.min_zoom && std::floor(zoom) <= summary.max_zoom) matrices.push_back(i);
  }
  return matrices;
}

/// The sets that have tiles of all layers.
std::vector<TileMatrixSetPtr> sets_of(const TiledResource& resource,
                                      const DocumentRequest& request) {
  std::vector<TileMatrixSetPtr> sets = request.sets.of(request.dataset);
  std::erase_if(sets, [&](const TileMatrixSetPtr& set) {
    return std::ranges::any_of(resource.layers, [&](const std::string& layer) {
      return served_in(request.dataset, layer, *set->system) == nullptr;
    });
  });
  return sets;
}

TileMatrixSetPtr find_set(const std::string& id, std::span<const TileMatrixSetPtr> sets) {
  const auto found = std::ranges::find(sets, id, &TileMatrixSet::id);
  return found == sets.end() ? nullptr : *found;
}

Result<Json> tilesets_json(const TiledResource& resource, const DocumentRequest& request) {
  const auto summary = summarize_layers(resource.layers, request.dataset);
  if (!summary) return summary.problem();
  const auto query = query_of(resource, request);
  if (!query) return query.problem();
  const std::string url = tiles_url(request, resource);
  Json tilesets = Json::array();
  for (const TileMatrixSetPtr& set : sets_of(resource, request)) {
    if (matrices_of(*summary, *set).empty()) continue;
    const std::string tileset_url = fmt::format("{}/{}{}", url, set->id, *query);
    Json tileset = tileset_head(*summary, *set);
    tileset["links"] = Json::array(
        {link("self", kJsonType, "The tileset", tileset_url),
         link(kTilingSchemeRelation, kJsonType, set->title, matrix_set_url(*set, request))});
    tilesets.push_back(std::move(tileset));
  }
  const Json self = link("self", kJsonType, "This document", url + *query);
  return Json{{"links", Json::array({self})}, {"tilesets", std::move(tilesets)}};
}

Json bounding_box(const GeographicBounds& bounds) {
  return {{"lowerLeft", {bounds[0], bounds[1]}},
          {"upperRight", {bounds[2], bounds[3]}},
          {"crs", crs84()->uri}};
}

/// Limits zooms only: if rows or columns are limited, GDAL 3.6, as in Debian 12, stretches the
/// tiles, or finds none.
Json limits_json(const LayerSummary& summary, const TileMatrixSet& set) {
  Json limits = Json::array();
  for (const std::size_t i : matrices_of(summary, set)) {
    const TileMatrix& matrix = set.matrices[i];
    limits.push_back({{"tileMatrix", matrix.id},
                      {"minTileRow", 0},
                      {"maxTileRow", matrix.height - 1},
                      {"minTileCol", 0},
                      {"maxTileCol", matrix.width - 1}});
  }
  return limits;
}

Result<Json> tileset_json(const TiledResource& resource, const std::string& matrix_set,
                          const DocumentRequest& request) {
  const std::vector<TileMatrixSetPtr> sets = sets_of(resource, request);
  const TileMatrixSetPtr set = find_set(matrix_set, sets);
  if (set == nullptr) return unknown_tile_matrix_set(matrix_set, names_of(sets));
  const auto summarized = summarize_layers(resource.layers, request.dataset);
  if (!summarized) return summarized.problem();
  const auto query = query_of(resource, request);
  if (!query) return query.problem();
  const auto& summary = *summarized;
  const std::string url = fmt::format("{}/{}", tiles_url(request, resource), set->id);
  Json json = tileset_head(summary, *set);
  if (!summary.description.empty()) json["description"] = summary.description;
  const auto style = request.style_for(resource.layers, kOgcApiParameters);
  if (!style) return style.problem();
  const std::string attribution =
      attribution_of(summary.attribution, resource.layers, *style, request.dataset);
  if (!attribution.empty()) json["attribution"] = attribution;
  json["boundingBox"] = bounding_box(summary.bounds());
  json["tileMatrixSetLimits"] = limits_json(summary, *set);
  Json item =
      link("item", kPngType, "The tiles", url + "/{tileMatrix}/{tileRow}/{tileCol}" + *query);
  item["templated"] = true;
  json["links"] = Json::array(
      {link("self", kJsonType, "This document", url + *query),
       link(kTilingSchemeRelation, kJsonType, set->title, matrix_set_url(*set, request)), item});
  return json;
}

Json matrix_sets_json(const DocumentRequest& request) {
  Json sets = Json::array();
  for (const TileMatrixSetPtr& set : request.sets.of(request.dataset)) {
    Json json = {{"id", set->id}, {"title", set->title}, {"crs", set->system->uri}};
    if (!set->uri.empty()) json["uri"] = set->uri;
    json["links"] =
        Json::array({link("self", kJsonType, set->title, matrix_set_url(*set, request))});
    sets.push_back(std::move(json));
  }
  return {{"tileMatrixSets", std::move(sets)}};
}

/// A place in the axis order of the reference system.
Json place_json(const MapSystem& system, double x, double y) {
  return system.is_north_first ? Json{y, x} : Json{x, y};
}

/// The names of both axes, in the same order.
Json axes_json(const MapSystem& system) {
  if (system.is_in_degrees) return system.is_north_first ? Json{"Lat", "Lon"} : Json{"Lon", "Lat"};
  return system.is_north_first ? Json{"Y", "X"} : Json{"X", "Y"};
}

/// The bounds of the first matrix.
Json matrix_set_box(const TileMatrixSet& set) {
  const TileMatrix& first = set.matrices.front();
  const double width = first.cell_size * first.tile_width * first.width;
  const double height = first.cell_size * first.tile_height * first.height;
  const MapSystem& system = *set.system;
  const double south = first.is_from_south ? first.origin_y : first.origin_y - height;
  return {{"lowerLeft", place_json(system, first.west, south)},
          {"upperRight", place_json(system, first.west + width, south + height)},
          {"crs", system.uri},
          {"orderedAxes", axes_json(system)}};
}

/// In the terms of version 2 of the standard. Members renamed since version 1 are also included
/// under their old name, the only one that GDAL 3.6, as in Debian 12, knows.
Json matrix_set_json(const TileMatrixSet& set, const DocumentRequest& request) {
  Json matrices = Json::array();
  for (const TileMatrix& matrix : set.matrices) {
    const Json origin = place_json(*set.system, matrix.west, matrix.origin_y);
    matrices.push_back({{"id", matrix.id},
                        {"identifier", matrix.id},
                        {"scaleDenominator", matrix.scale_denominator},
                        {"cellSize", matrix.cell_size},
                        {"cornerOfOrigin", matrix.is_from_south ? "bottomLeft" : "topLeft"},
                        {"pointOfOrigin", origin},
                        {"tileWidth", matrix.tile_width},
                        {"tileHeight", matrix.tile_height},
                        {"matrixWidth", matrix.width},
                        {"matrixHeight", matrix.height}});
    if (!matrix.is_from_south) matrices.back()["topLeftCorner"] = origin;
  }
  Json json;
  json["id"] = set.id;
  json["title"] = set.title;
  if (!set.uri.empty()) json["uri"] = set.uri;
  json["crs"] = set.system->uri;
  json["supportedCRS"] = set.system->uri;
  json["orderedAxes"] = axes_json(*set.system);
  json["boundingBox"] = matrix_set_box(set);
  if (!set.scale_set.empty()) json["wellKnownScaleSet"] = set.scale_set;
  json["tileMatrices"] = matrices;
  json["links"] = Json::array({link("self", kJsonType, set.title, matrix_set_url(set, request))});
  return json;
}

Result<Json> matrix_set_of(const std::string& id, const DocumentRequest& request) {
  const std::vector<TileMatrixSetPtr> sets = request.sets.of(request.dataset);
  const TileMatrixSetPtr set = find_set(id, sets);
  if (set == nullptr) return unknown_tile_matrix_set(id, names_of(sets));
  return matrix_set_json(*set, request);
}

std::span<const std::string> whole_path(const DocumentRequest& request) {
  const auto path = std::span(request.path);
  return path.back().empty() ? path.first(path.size() - 1) : path;  // for "/ogc/"
}

std::span<const std::string> path_below_ogc(const DocumentRequest& request) {
  return whole_path(request).subspan(1);
}

/// The resource at the beginning of a path of tiles.
Result<TiledResource> tiled_resource(std::span<const std::string> path,
                                     const DocumentRequest& request) {
  return path[0] == "collections" ? tiled_collection(path[1], request.dataset)
                                  : tiled_dataset(request);
}

std::optional<Problem> check_format(const DocumentRequest& request, std::string_view format) {
  const std::string* asked = request.find("f");
  if (asked == nullptr || *asked == format) return std::nullopt;
  return Problem{400, fmt::format("The parameter f takes {} here.", format), "f", *asked,
                 std::string(format)};
}

const Route* route_of(const DocumentRequest& request) {
  return find_route(whole_path(request));
}

Result<Json> collection_of(const std::string& name, const DocumentRequest& request) {
  const auto position = request.dataset.find(name);
  if (!position) return unknown_layer(name, request.dataset);
  return collection_json(request.dataset.layers()[*position], request);
}

Result<Json> tilesets_of(std::span<const std::string> path, const DocumentRequest& request) {
  const auto resource = tiled_resource(path, request);
  if (!resource) return resource.problem();
  return tilesets_json(*resource, request);
}

Result<Json> tileset_of(std::span<const std::string> path, const DocumentRequest& request) {
  const auto resource = tiled_resource(path, request);
  if (!resource) return resource.problem();
  return tileset_json(*resource, path.back(), request);
}

Result<Json> find_json(const Route& route, const DocumentRequest& request) {
  const auto path = path_below_ogc(request);
  switch (route.id) {
    case RouteId::landing_page:
      return landing_page(request);
    case RouteId::conformance:
      return Json{{"conformsTo", kConformance}};
    case RouteId::collections:
      return collections_json(request);
    case RouteId::collection:
      return collection_of(path[1], request);
    case RouteId::collection_tilesets:
    case RouteId::dataset_tilesets:
      return tilesets_of(path, request);
    case RouteId::collection_tileset:
    case RouteId::dataset_tileset:
      return tileset_of(path, request);
    case RouteId::matrix_sets:
      return matrix_sets_json(request);
    case RouteId::matrix_set:
      return matrix_set_of(path[1], request);
    default:
      return nothing_below_ogc();
  }
}

Result<WindowRequest> map_of(std::span<const std::string> path, const DocumentRequest& request) {
  const auto resource = tiled_resource(path, request);
  if (!resource) return resource.problem();
  return parse_ogc_map(resource->layers, request);
}

Result<TileRequest> tile_of(std::span<const std::string> path, const DocumentRequest& request) {
  if (auto problem = check_format(request, "png")) return std::move(*problem);
  auto resource = tiled_resource(path, request);
  if (!resource) return std::move(resource).problem();
  const auto numbers = path.last(4);  // tile matrix set, tile matrix, row, column
  const std::vector<TileMatrixSetPtr> sets = sets_of(*resource, request);
  const TileMatrixSetPtr set = find_set(numbers[0], sets);
  if (set == nullptr) return unknown_tile_matrix_set(numbers[0], names_of(sets));
  const auto tile = parse_tile_id(numbers[1], numbers[3], numbers[2], *set);
  if (!tile) return tile.problem();
  TileRequest parsed{std::move(resource->layers), *tile, 1, {}, TileFormat::png, set};
  auto style = request.style_for(parsed.layers, kOgcApiParameters);
  if (!style) return std::move(style).problem();
  parsed.style = *std::move(style);
  return parsed;
}

}  // namespace

Result<Document> ogc_document(const DocumentRequest& request) {
  if (auto problem = check_format(request, "json")) return std::move(*problem);
  const Route* route = route_of(request);
  if (route == nullptr) return nothing_below_ogc();
  if (route->id == RouteId::api) {
    return Document{std::string(kOpenApiType), openapi_json(request)};
  }
  const auto json = find_json(*route, request);
  if (!json) return json.problem();
  return Document{std::string(kJsonType), to_text(*json)};
}

std::optional<Result<PictureRequest>> parse_ogc_picture(const DocumentRequest& request) {
  const Route* route = route_of(request);
  if (route == nullptr) return std::nullopt;
  const auto path = path_below_ogc(request);
  const auto as_picture = [](auto picture) -> Result<PictureRequest> {
    if (!picture) return std::move(picture).problem();
    return PictureRequest(*std::move(picture));
  };
  switch (route->id) {
    case RouteId::collection_tile:
    case RouteId::dataset_tile:
      return as_picture(tile_of(path, request));
    case RouteId::collection_map:
    case RouteId::dataset_map:
      return as_picture(map_of(path, request));
    default:
      return std::nullopt;
  }
}

}  // namespace trapeze
