// The capabilities document of WMS.
#pragma once

#include "server/documents/document.h"
#include "server/documents/wms_request.h"

namespace trapeze {

/// The capabilities: layers with their bounds, the styles that fit each of them, legends,
/// attributions, and the scales at which they are drawn. A style in the query is kept in the URLs
/// for maps and features.
Document wms_capabilities(const WmsCapabilitiesRequest& asked, const DocumentRequest& request);

}  // namespace trapeze
