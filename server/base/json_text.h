// How documents become JSON text: one way for all. For sources only: no header of the server needs
// to know the JSON library.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/layer/feature_table.h"
#include "render/picture/colour.h"

namespace trapeze {

/// Keeps its members in the order in which they were added.
using Json = nlohmann::ordered_json;

/// Indented, with a line end; what is not UTF-8 is replaced.
std::string to_text(const Json& json);

/// Integers keep all of their 64 bits; numbers that are not finite become null.
Json to_json(const Value& value);

/// "#rrggbb"; the opacity is told apart from it.
std::string css_colour(Rgba colour);

}  // namespace trapeze
