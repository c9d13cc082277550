// Documents that describe the served layers, as JSON text.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/layer/feature_table.h"
#include "server/base/result.h"
#include "server/data/dataset.h"
#include "server/tiles/tile_request.h"

namespace trapeze {

/// The name of that type in JSON Schema.
std::string_view json_type_of(FieldType type);

/// {"layers": [...], "generation": ..., "renderer": ..., "parameters": [...], "viewer": {"title":
/// ..., "start": ...}}. The bounds of a layer without polygons are null; "title_attribute", "group"
/// and "detail_zoom" of a layer are present if they are known. `base_url` is the URL of this
/// server, without a final '/'.
std::string catalog_json(const Dataset& dataset, const std::string& renderer,
                         const ViewerConfig& viewer, const std::string& base_url);

/// The attribution of the layers, and those of the configured tables whose values they show in that
/// style, or in their own.
std::string attribution_of(std::string own, std::span<const std::string> layers,
                           const StyleQuery& style, const Dataset& dataset);

/// TileJSON 3.0 of the layers drawn together, with the style of the request in its tile URLs. The
/// problem is 404 for an unknown layer.
Result<std::string> tile_json(const TileJsonRequest& request, const Dataset& dataset,
                              const std::string& base_url);

}  // namespace trapeze
