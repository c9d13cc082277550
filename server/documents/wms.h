// WMS 1.3.0 and 1.1.1: capabilities, features at a pixel of a map, and legends.
#pragma once

#include <optional>

#include "server/base/result.h"
#include "server/documents/document.h"
#include "server/tiles/window_request.h"

namespace trapeze {

/// The capabilities, the features of GetFeatureInfo, or the legend of GetLegendGraphic. Problems
/// are those of parse_wms_request().
Result<Document> wms_document(const DocumentRequest& request);

/// The requested map, or what is wrong with the request; nothing if a document is requested.
std::optional<Result<PictureRequest>> parse_wms_map(const DocumentRequest& request);

}  // namespace trapeze
