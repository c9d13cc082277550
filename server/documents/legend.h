// What the colours of a map mean.
#pragma once

#include <string>

#include "server/base/result.h"
#include "server/documents/document.h"

namespace trapeze {

/// /legend/{layers}.json, or /legend/{layers}[@2x].png, in the style of the query: for each layer,
/// the topmost first, its title and one entry for each way in which its polygons are drawn. The
/// picture shows a small polygon for each, with pattern and outline as in the map, but
/// no outline wider than 4 pixels.
Result<Document> legend_document(const DocumentRequest& request);

/// Of the picture at scale 1, in pixels.
struct LegendSize {
  int width = 0;
  int height = 0;
};
/// The problem is a layer that there is not, or a style of the query that does not fit it.
Result<LegendSize> legend_size(const std::string& layer, const DocumentRequest& request);

}  // namespace trapeze
