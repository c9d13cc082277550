// The OpenAPI 3.0 document of the server; the query parameters come from their table.
#pragma once

#include <string>

#include "server/documents/document.h"

namespace trapeze {

/// JSON, with the tile matrix sets and reference systems of the dataset.
std::string openapi_json(const DocumentRequest& request);

}  // namespace trapeze
