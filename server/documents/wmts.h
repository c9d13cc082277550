// WMTS 1.0.0: capabilities at /wmts.xml, which name the tiles by RESTful templates, and the same
// by key-value pairs at /wmts.
#pragma once

#include <optional>

#include "server/base/result.h"
#include "server/documents/document.h"
#include "server/tiles/tile_request.h"

namespace trapeze {

/// The capabilities, for /wmts.xml and for /wmts?request=GetCapabilities.
Result<Document> wmts_document(const DocumentRequest& request);

/// The tile of /wmts?request=GetTile&...; nothing if another request is made. Further pairs of the
/// query style the tile. Keys may be written in either case.
std::optional<Result<TileRequest>> parse_wmts_tile(const DocumentRequest& request);

}  // namespace trapeze
