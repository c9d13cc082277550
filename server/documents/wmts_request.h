// Requests to WMTS 1.0.0, as key-value pairs at /wmts, with keys that ignore case, or as URLs:
//
//   /wmts.xml, /wmts/1.0.0/WMTSCapabilities.xml
//   /wmts/{Layer}/{Style}/{TileMatrixSet}/{TileMatrix}/{TileRow}/{TileCol}.png
//   /wmts/{Layer}/{Style}/{TileMatrixSet}/{TileMatrix}/{TileRow}/{TileCol}/{J}/{I}.{json,txt,html}
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/base/result.h"
#include "server/data/dataset.h"
#include "server/documents/document.h"
#include "server/documents/identify.h"
#include "server/tiles/tile_matrix_set.h"
#include "server/tiles/tile_request.h"

namespace trapeze {

constexpr std::string_view kWmtsVersion = "1.0.0";
constexpr std::string_view kWmtsFormat = "image/png";

/// The requested sections of the capabilities.
struct WmtsCapabilitiesRequest {
  bool identification = true;
  bool operations = true;
  bool contents = true;
};

/// A query for the features at a pixel of a tile.
struct WmtsFeatureInfoRequest {
  PlaceQuery query;
  IdentifyFormat format = IdentifyFormat::json;
  std::string content_type;
};

using WmtsRequest = std::variant<WmtsCapabilitiesRequest, TileRequest, WmtsFeatureInfoRequest>;

/// How far outside its bounds the layer may show something in its own style or in a named one, in
/// pixels: outlines, grown features and labels.
double wmts_margin(const ServedLayer& layer, const StyleBook& styles);
/// The tiles of a matrix in which the layer may show something, with that margin. In WMTS, there
/// are no tiles outside these, unless the style of a request needs a wider margin.
TileLimits wmts_limits(const ServedLayer& layer, const TileMatrixSet& set, std::size_t matrix,
                       double margin);
/// The sets with tiles of some layer, without those whose rows are not counted from the north, as
/// WMTS requires.
std::vector<TileMatrixSetPtr> wmts_sets(const DocumentRequest& request);
/// Whether the layer is drawn at that scale.
bool has_tiles_of(const ServedLayer& layer, const TileMatrix& matrix);

/// The problem has an OWS code and the parameter name of WMTS; its status is 404 for anything that
/// does not exist, else 400 or 501. Other pairs of the query style the tile; pairs that do not
/// resemble a style parameter are ignored, as the standard requires.
Result<WmtsRequest> parse_wmts_request(const DocumentRequest& request);

/// Whether the percent-encoded path is the one for key-value pairs.
bool is_wmts_key_value_path(std::string_view path);

}  // namespace trapeze
