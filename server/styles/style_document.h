// Styles as JSON documents: the parameters of the query by their names, or what a fill layer of a
// MapLibre style says about its paint.
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
/// Lists may be arrays; layers may be named before parameters, too: "water.fill". A layer of a
/// MapLibre style of type "fill", or its paint alone, is understood as far as its fill-color,
/// fill-opacity and fill-outline-color go, if they are no expressions. The problem, 400, names what
/// is not understood: nothing is left out in silence.
Result<StyleQuery> parse_style_document(std::string_view text);

/// The same style as a document.
std::string style_document(const StyleQuery& style);

}  // namespace trapeze
