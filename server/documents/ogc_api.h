// OGC API - Tiles 1.0 below /ogc: the layers as collections, their tiles in WebMercatorQuad, and
// the documents that lead there. Rows come before columns here.
#pragma once

#include <optional>

#include "server/base/result.h"
#include "server/documents/document.h"
#include "server/tiles/window_request.h"

namespace trapeze {

/// Landing page, conformance, OpenAPI, collections, tilesets and tile matrix sets, all JSON.
Result<Document> ogc_document(const DocumentRequest& request);

/// The tile that a path below /ogc names; nothing if it names none.
std::optional<Result<PictureRequest>> parse_ogc_picture(const DocumentRequest& request);

}  // namespace trapeze
