// OGC API - Maps: a map of one or several collections.
#pragma once

#include <span>
#include <string>

#include "server/base/result.h"
#include "server/documents/document.h"
#include "server/tiles/window_request.h"

namespace trapeze {

/// The map of these layers requested by a query with bbox, bbox-crs, crs, width, height, bgcolor,
/// transparent and f, and with style parameters. Without bbox it shows the layers in full. The
/// problem is 400, or 404 for an unknown layer.
Result<WindowRequest> parse_ogc_map(const std::vector<std::string>& layers,
                                    const DocumentRequest& request);

}  // namespace trapeze
