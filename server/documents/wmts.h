// WMTS 1.0.0: capabilities, and features at a pixel of a tile.
#pragma once

#include <optional>

#include "server/base/result.h"
#include "server/documents/document.h"
#include "server/tiles/window_request.h"

namespace trapeze {

/// The capabilities, or the features of GetFeatureInfo. Problems are those of parse_wmts_request().
Result<Document> wmts_document(const DocumentRequest& request);

/// The requested tile, or what is wrong with the request; nothing if a document is requested.
std::optional<Result<PictureRequest>> parse_wmts_tile(const DocumentRequest& request);

}  // namespace trapeze
