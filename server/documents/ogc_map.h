// OGC API - Maps: a map of one collection, or of several.
#pragma once

#include <span>
#include <string>

#include "server/base/result.h"
#include "server/documents/document.h"
#include "server/tiles/window_request.h"

namespace trapeze {

/// The map of these layers that a query asks for by bbox, bbox-crs, crs, width, height, bgcolor,
/// transparent and f, and by parameters of styles. Without bbox it shows all of the layers. The
/// problem is 400, or 404 for a layer that there is not.
Result<WindowRequest> parse_ogc_map(const std::vector<std::string>& layers,
                                    const DocumentRequest& request);

}  // namespace trapeze
