// OGC API - Tiles 1.0 below /ogc: the layers as collections, their tiles in WebMercatorQuad and
// other tile matrix sets, and the documents that link to them. In these URLs, rows come before
// columns.
#pragma once

#include <optional>

#include "server/base/result.h"
#include "server/documents/document.h"
#include "server/tiles/window_request.h"

namespace trapeze {

/// The landing page, conformance, OpenAPI, collections, tilesets and tile matrix sets, all as JSON.
Result<Document> ogc_document(const DocumentRequest& request);

/// The tile that a path below /ogc refers to; nothing if it does not refer to a tile.
std::optional<Result<PictureRequest>> parse_ogc_picture(const DocumentRequest& request);

}  // namespace trapeze
