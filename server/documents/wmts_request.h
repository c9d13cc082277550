// What is asked of WMTS 1.0.0, by key-value pairs at /wmts, where keys may be written in any case
// of letters, or by addresses:
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

/// The sections of the capabilities that are asked for.
struct WmtsCapabilitiesRequest {
  bool identification = true;
  bool operations = true;
  bool contents = true;
};

/// What lies under a pixel of a tile.
struct WmtsFeatureInfoRequest {
  PlaceQuery query;
  IdentifyFormat format = IdentifyFormat::json;
  std::string content_type;
};

using WmtsRequest = std::variant<WmtsCapabilitiesRequest, TileRequest, WmtsFeatureInfoRequest>;

/// The tiles of a matrix in which the layer may show something: outside, there is no tile to WMTS.
/// With a margin for outlines.
TileLimits wmts_limits(const ServedLayer& layer, const TileMatrixSet& set, std::size_t matrix);
/// The sets that have tiles of some layer: of those whose rows are counted from the north, as WMTS
/// counts them.
std::vector<TileMatrixSetPtr> wmts_sets(const DocumentRequest& request);
/// Whether the layer is drawn at that scale.
bool has_tiles_of(const ServedLayer& layer, const TileMatrix& matrix);

/// The problem has a code of OWS and the parameter as WMTS calls it; 404 for what there is not,
/// else 400 or 501. Other pairs of the query style the tile; those that have no likeness to a
/// parameter of styles are passed over, as the standard wants it.
Result<WmtsRequest> parse_wmts_request(const DocumentRequest& request);

/// Whether the path, which is still encoded, is the one that takes key-value pairs.
bool is_wmts_key_value_path(std::string_view path);

}  // namespace trapeze
