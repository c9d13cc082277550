#include "server/documents/routes.h"

#include <algorithm>
#include <array>

namespace trapeze {
namespace {

constexpr std::string_view kJson = "application/json";
constexpr std::string_view kPng = "image/png";
constexpr std::string_view kWebp = "image/webp";
constexpr std::string_view kMapQuery =
    "map-bbox bbox-crs map-crs width height bgcolor transparent map-f";
constexpr std::string_view kDatasetMapQuery =
    "collections map-bbox bbox-crs map-crs width height bgcolor transparent map-f";
constexpr std::string_view kWindowQuery = "window window-crs width height";

constexpr std::array kRoutes = {
    Route{RouteId::tile, "/tiles/{layers}/{z}/{x}/{y}.png", "getTile", "A tile of 256 pixels", kPng,
          true},
    Route{RouteId::tile_at_2x, "/tiles/{layers}/{z}/{x}/{y}@2x.png", "getTile2x",
          "A tile of 512 pixels", kPng, true},
    Route{RouteId::webp_tile, "/tiles/{layers}/{z}/{x}/{y}.webp", "getWebpTile",
          "A tile of 256 pixels, as WebP", kWebp, true},
    Route{RouteId::styled_tile, "/tiles/{layers}/s/{style}/{z}/{x}/{y}.png", "getStyledTile",
          "A tile in a named or posted style", kPng},
    Route{RouteId::tile, "/tiles/{layers}/{tileMatrixSetId}/{z}/{x}/{y}.png", "getTileOfSet",
          "A tile of a tile matrix set", kPng, true},
    Route{RouteId::tile_json_at_2x, "/tiles/{layers}@2x.json", "getTileJson2x",
          "TileJSON 3.0 of the tiles of 512 pixels", kJson, true},
    Route{RouteId::tile_json, "/tiles/{layers}.json", "getTileJson", "TileJSON 3.0 of layers",
          kJson, true},
    Route{RouteId::styled_tile_json, "/tiles/{layers}/s/{style}.json", "getStyledTileJson",
          "TileJSON 3.0 of layers in a named or posted style", kJson},
    Route{RouteId::map_window, "/map/{layers}.png", "getMapPicture",
          "An image of a part of the map", kPng, true, kWindowQuery},
    Route{RouteId::map_window, "/map/{layers}@2x.png", "getMapPicture2x",
          "The same with twice as many pixels in both directions", kPng, true, kWindowQuery},
    Route{RouteId::map_window, "/map/{layers}.webp", "getMapPictureWebp", "The same as WebP", kWebp,
          true, kWindowQuery},
    Route{RouteId::map_window, "/map/{layers}/s/{style}.png", "getStyledMapPicture",
          "The same in a named or posted style", kPng, false, kWindowQuery},
    Route{RouteId::map_around, "/map/{layers}/{centre}/{size}.png", "getMapPictureAround",
          "A picture around a place", kPng, true},
    Route{RouteId::map_around, "/map/{layers}/{centre}/{size}@2x.png", "getMapPictureAround2x",
          "The same with twice as many pixels in both directions", kPng, true},
    Route{RouteId::map_around, "/map/{layers}/{centre}/{size}.webp", "getMapPictureAroundWebp",
          "The same as WebP", kWebp, true},
    Route{RouteId::map_around, "/map/{layers}/s/{style}/{centre}/{size}.png",
          "getStyledMapPictureAround", "The same in a named or posted style", kPng},
    Route{RouteId::styles, "/styles", "getStyles", "The names of styles", kJson},
    Route{RouteId::style, "/styles/{style}", "getStyle", "A style, by name or id", kJson},
    Route{RouteId::post_style,
          "/styles",
          "postStyle",
          "Post a style; equal styles have the same id",
          kJson,
          false,
          {},
          "POST"},
    Route{RouteId::legend_picture, "/legend/{layers}.png", "getLegendPicture",
          "The legend, as an image", kPng, true},
    Route{RouteId::legend, "/legend/{layers}.json", "getLegend", "What the colours mean", kJson,
          true},
    Route{RouteId::identify, "/identify/{layers}/{place}", "identify", "The features at a location",
          "application/geo+json", true, "z"},
    Route{RouteId::values, "/values/{layer}/{attribute}", "getValues",
          "The values of an attribute and their distribution", kJson, true, "bbox"},
    Route{RouteId::value_tables, "/values", "getValueTables", "The configured value tables", kJson},
    Route{RouteId::value_table, "/values/{table}", "getValueTable",
          "A value table, by name or id, and how it matches the layers", kJson, false,
          "table-layer table-join"},
    Route{RouteId::post_values, "/values", "postValues",
          "Post a table of keys and values; equal tables have the same id", kJson, false,
          "table-key table-value table-layer table-join", "POST"},
    Route{RouteId::catalog, "/catalog", "getCatalog", "The layers and the parameters", kJson},
    Route{RouteId::wms, "/wms", {}, "WMS 1.3.0 and 1.1.1, by key-value pairs", "text/xml"},
    Route{RouteId::wmts_capabilities, "/wmts.xml", "getWmtsCapabilities", "WMTS 1.0.0 capabilities",
          "application/xml"},
    Route{
        RouteId::wmts_key_values, "/wmts", {}, "WMTS 1.0.0 by key-value pairs", "application/xml"},
    Route{RouteId::wmts_version_capabilities,
          "/wmts/1.0.0/WMTSCapabilities.xml",
          {},
          "WMTS 1.0.0 capabilities, where some clients look for them",
          "application/xml"},
    Route{RouteId::wmts_tile,
          "/wmts/{layers}/{style}/{tileMatrixSetId}/{tileMatrix}/{tileRow}/{tileCol}.png",
          "getWmtsTile", "A tile, as WMTS names it", kPng},
    Route{RouteId::wmts_feature_info,
          "/wmts/{layers}/{style}/{tileMatrixSetId}/{tileMatrix}/{tileRow}/{tileCol}/{j}/{i}.json",
          "getWmtsFeatureInfo", "The features under a pixel of a tile", "application/geo+json"},
    Route{RouteId::wmts_feature_info,
          "/wmts/{layers}/{style}/{tileMatrixSetId}/{tileMatrix}/{tileRow}/{tileCol}/{j}/{i}.txt",
          "getWmtsFeatureInfoText", "The same in words", "text/plain"},
    Route{RouteId::wmts_feature_info,
          "/wmts/{layers}/{style}/{tileMatrixSetId}/{tileMatrix}/{tileRow}/{tileCol}/{j}/{i}.html",
          "getWmtsFeatureInfoHtml", "The same as a page", "text/html"},
    Route{RouteId::health, "/health", {}, "Whether the process responds", kJson},
    Route{RouteId::ready, "/ready", {}, "Whether layers are served", kJson},
    Route{RouteId::metrics, "/metrics", {}, "Figures for Prometheus", "text/plain"},
    Route{RouteId::landing_page, "/ogc", "getLandingPage", "Landing page", kJson},
    Route{RouteId::conformance, "/ogc/conformance", "getConformance", "Conformance classes", kJson},
    Route{RouteId::api, "/ogc/api", "getApi", "This document", kOpenApiType},
    Route{RouteId::collections, "/ogc/collections", "getCollections", "The layers", kJson},
    Route{RouteId::collection, "/ogc/collections/{collectionId}", "getCollection", "A layer",
          kJson},
    Route{RouteId::collection_map, "/ogc/collections/{collectionId}/map",
          "trapeze.collection.getMap", "A map of a layer", kPng, true, kMapQuery},
    Route{RouteId::collection_tilesets, "/ogc/collections/{collectionId}/map/tiles",
          "trapeze.collection.map.getTileSetsList", "The tilesets of a layer", kJson, true},
    Route{RouteId::collection_tileset,
          "/ogc/collections/{collectionId}/map/tiles/{tileMatrixSetId}",
          "trapeze.collection.map.getTileSet", "A tileset of a layer", kJson, true},
    Route{RouteId::collection_tile,
          "/ogc/collections/{collectionId}/map/tiles/{tileMatrixSetId}/{tileMatrix}/{tileRow}/"
          "{tileCol}",
          "trapeze.collection.map.getTile", "A tile of a layer", kPng, true},
    Route{RouteId::dataset_map, "/ogc/map", "trapeze.dataset.getMap", "A map of all layers", kPng,
          true, kDatasetMapQuery},
    Route{RouteId::dataset_tilesets, "/ogc/map/tiles", "trapeze.dataset.map.getTileSetsList",
          "The tilesets of all layers", kJson, true, "collections"},
    Route{RouteId::dataset_tileset, "/ogc/map/tiles/{tileMatrixSetId}",
          "trapeze.dataset.map.getTileSet", "A tileset of all layers", kJson, true, "collections"},
    Route{RouteId::dataset_tile,
          "/ogc/map/tiles/{tileMatrixSetId}/{tileMatrix}/{tileRow}/{tileCol}",
          "trapeze.dataset.map.getTile", "A tile of all layers", kPng, true, "collections"},
    Route{RouteId::matrix_sets, "/ogc/tileMatrixSets", "getTileMatrixSetsList",
          "The tile matrix sets", kJson},
    Route{RouteId::matrix_set, "/ogc/tileMatrixSets/{tileMatrixSetId}", "getTileMatrixSet",
          "A tile matrix set", kJson},
};

constexpr std::array<std::string_view, kAreas> kAreaNames = {
    "tiles", "map",  "legend", "identify", "values", "catalog", "styles",
    "wms",   "wmts", "ogc",    "health",   "ready",  "metrics", "other"};

/// Removes the first segment, and the slash before it, from a path.
constexpr std::string_view take_segment(std::string_view& path) {
  path.remove_prefix(path.starts_with('/') ? 1 : 0);
  const std::string_view segment = path.substr(0, path.find('/'));
  path.remove_prefix(segment.size());
  return segment;
}

constexpr std::string_view first_segment(std::string_view path) {
  return take_segment(path);
}

/// "wmts" for "wmts.xml".
constexpr std::string_view stem_of(std::string_view segment) {
  return segment.substr(0, segment.find('.'));
}

constexpr bool all_have_an_area() {
  return std::ranges::all_of(kRoutes, [](const Route& route) {
    return std::ranges::find(kAreaNames, stem_of(first_segment(route.path))) != kAreaNames.end();
  });
}
static_assert(all_have_an_area());

bool matches_segment(std::string_view segment, std::string_view pattern) {
  if (!pattern.starts_with('{')) return segment == pattern;
  const std::string_view ending = pattern.substr(pattern.find('}') + 1);
  return segment.size() >= ending.size() && segment.ends_with(ending);
}

bool matches(std::span<const std::string> segments, std::string_view pattern) {
  for (const std::string& segment : segments) {
    if (pattern.empty() || !matches_segment(segment, take_segment(pattern))) return false;
  }
  return pattern.empty();
}

}  // namespace

std::string_view name_of(Area area) {
  return kAreaNames[static_cast<std::size_t>(area)];
}

std::span<const Route> routes() {
  return kRoutes;
}

Area area_of(std::string_view path) {
  const std::string_view first = first_segment(path);
  const auto is_first = [first](const Route& route) { return first_segment(route.path) == first; };
  if (std::ranges::none_of(kRoutes, is_first)) return Area::other;
  return Area(std::ranges::find(kAreaNames, stem_of(first)) - kAreaNames.begin());
}

const Route* find_route(std::span<const std::string> segments) {
  const auto found = std::ranges::find_if(kRoutes, [segments](const Route& route) {
    return route.method == "GET" && matches(segments, route.path);
  });
  return found == kRoutes.end() ? nullptr : &*found;
}

std::string methods_of(std::string_view path) {
  std::string methods = "GET, HEAD, OPTIONS";
  for (const Route& route : kRoutes) {
    if (route.path == path && route.method != "GET") methods.append(", ").append(route.method);
  }
  return methods;
}

bool understands(std::string_view path, std::string_view method) {
  return method == "GET" || method == "HEAD" ||
         std::ranges::any_of(kRoutes, [path, method](const Route& route) {
           return route.path == path && route.method == method;
         });
}

}  // namespace trapeze
