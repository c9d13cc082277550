// Serialises JSON documents in the same way everywhere. Include it in source files only: no header
// of the server needs to know the JSON library.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/layer/feature_table.h"
#include "render/picture/colour.h"

namespace trapeze {

/// Keeps its members in insertion order.
using Json = nlohmann::ordered_json;

/// Indented, with a final line end; invalid UTF-8 is replaced.
std::string to_text(const Json& json);

/// Integers keep all 64 bits; numbers that are not finite become null.
Json to_json(const Value& value);

/// "#rrggbb"; the opacity is written separately.
std::string css_colour(Rgba colour);

}  // namespace trapeze
