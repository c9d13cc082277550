// Styles as JSON documents: the query parameters by name, or the paint of a fill layer of a
// MapLibre style.
#pragma once

#include <string>
#include <string_view>

#include "server/base/result.h"
#include "server/styles/style_parameters.h"

namespace trapeze {

/// Reads a document like
///
///   {"fill": "#cde", "stroke-width": 2, "classes": {"FRA": "red", "*": "silver"},
///    "layers": {"water": {"fill": "navy"}}}
///
/// Lists may be arrays; parameters may also be prefixed with a layer: "water.fill". A layer of a
/// MapLibre style of type "fill", or its paint alone, is supported as far as its fill-color,
/// fill-opacity and fill-outline-color go, if they are not expressions. The problem, 400, names
/// what is not understood: nothing is ignored silently.
Result<StyleQuery> parse_style_document(std::string_view text);

/// The style as a document.
std::string style_document(const StyleQuery& style);

}  // namespace trapeze
