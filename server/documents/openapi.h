// What can be asked for, as an OpenAPI 3.0 document; the query parameters come from their table.
#pragma once

#include <string>

namespace trapeze {

/// JSON. `base_url` is how this server is reached, without a '/' at the end.
std::string openapi_json(const std::string& base_url);

}  // namespace trapeze
