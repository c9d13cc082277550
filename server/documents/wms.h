// WMS 1.3.0 and 1.1.1: the capabilities, what lies under a pixel of a map, and legends.
#pragma once

#include <optional>

#include "server/base/result.h"
#include "server/documents/document.h"
#include "server/tiles/window_request.h"

namespace trapeze {

/// The capabilities, the features of GetFeatureInfo, or the legend of GetLegendGraphic. Problems
/// are those of parse_wms_request().
Result<Document> wms_document(const DocumentRequest& request);

/// The map that is asked for, or what is wrong with the request; nothing if a document is asked
/// for.
std::optional<Result<PictureRequest>> parse_wms_map(const DocumentRequest& request);

}  // namespace trapeze
