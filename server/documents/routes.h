// The table of all paths that this server understands, used for dispatching and counting requests,
// and for the OpenAPI document. It does not contain the viewer's files.
//
// Thread-safety: any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace trapeze {

/// The meaning of the first segment of a path.
enum class Area : std::uint8_t {
  tiles,
  map,
  legend,
  identify,
  values,
  catalog,
  styles,
  wms,
  wmts,
  ogc,
  health,
  ready,
  metrics,
  other,  // the viewer's files, and all unknown paths
};
constexpr std::size_t kAreas = static_cast<std::size_t>(Area::other) + 1;

/// "tiles".
std::string_view name_of(Area area);

/// The media type of the OpenAPI document.
constexpr std::string_view kOpenApiType = "application/vnd.oai.openapi+json;version=3.0";

enum class RouteId : std::uint8_t {
  tile,
  tile_at_2x,
  webp_tile,
  styled_tile,
  tile_json_at_2x,
  tile_json,
  styled_tile_json,
  map_window,
  map_around,
  styles,
  style,
  post_style,
  legend_picture,
  legend,
  identify,
  values,
  value_tables,
  value_table,
  post_values,
  catalog,
  wms,
  wmts_capabilities,
  wmts_key_values,
  wmts_version_capabilities,
  wmts_tile,
  wmts_feature_info,
  health,
  ready,
  metrics,
  landing_page,
  conformance,
  api,
  collections,
  collection,
  collection_map,
  collection_tilesets,
  collection_tileset,
  collection_tile,
  dataset_map,
  dataset_tilesets,
  dataset_tileset,
  dataset_tile,
  matrix_sets,
  matrix_set,
};

struct Route {
  RouteId id;
  std::string_view path;       // {name} represents a segment, or the rest of one
  std::string_view operation;  // its operationId in OpenAPI; empty: not listed there
  std::string_view summary;
  std::string_view content_type;
  bool has_style = false;       // accepts the style parameters
  std::string_view query = {};  // other parameters, by OpenAPI name, separated by spaces
  std::string_view method = "GET";
};

std::span<const Route> routes();

/// The area of a percent-encoded path.
Area area_of(std::string_view path);

/// The GET route for the decoded segments of a path; null if there is none. Names of pictures may
/// be anything with the extension of the route.
const Route* find_route(std::span<const std::string> segments);

/// "GET, HEAD, OPTIONS", and further methods that the percent-encoded path understands.
std::string methods_of(std::string_view path);
/// Whether the path understands a method other than OPTIONS.
bool understands(std::string_view path, std::string_view method);

}  // namespace trapeze
