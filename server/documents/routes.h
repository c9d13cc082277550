// Every path that this server understands, in one table: requests are dispatched by it, counted by
// it, and the OpenAPI document is made from it. The viewer's files are not in it.
//
// Thread-safety: any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace trapeze {

/// What the first segment of a path says.
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

/// Of the OpenAPI document itself.
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
  std::string_view path;       // {name} stands for a segment, or for the rest of one
  std::string_view operation;  // its operationId in OpenAPI; empty: not listed there
  std::string_view summary;
  std::string_view content_type;
  bool has_style = false;       // takes the parameters of styles
  std::string_view query = {};  // others that it takes, as OpenAPI names them, blanks between
  std::string_view method = "GET";
};

std::span<const Route> routes();

/// The area of a path, which is still encoded.
Area area_of(std::string_view path);

/// The route of GET for the decoded segments of a path; null if there is none. Names of pictures
/// may be anything that ends as the route does.
const Route* find_route(std::span<const std::string> segments);

/// "GET, HEAD, OPTIONS", and what else the path, which is still encoded, understands.
std::string methods_of(std::string_view path);
/// Whether it understands a method other than OPTIONS.
bool understands(std::string_view path, std::string_view method);

}  // namespace trapeze
