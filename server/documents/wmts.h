// WMTS 1.0.0: the capabilities, and what lies under a pixel of a tile.
#pragma once

#include <optional>

#include "server/base/result.h"
#include "server/documents/document.h"
#include "server/tiles/window_request.h"

namespace trapeze {

/// The capabilities, or the features of GetFeatureInfo. Problems are those of parse_wmts_request().
Result<Document> wmts_document(const DocumentRequest& request);

/// The tile that is asked for, or what is wrong with the request; nothing if a document is asked
/// for.
std::optional<Result<PictureRequest>> parse_wmts_tile(const DocumentRequest& request);

}  // namespace trapeze
