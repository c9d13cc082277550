// Legends of maps.
#pragma once

#include <string>

#include "server/base/result.h"
#include "server/documents/document.h"

namespace trapeze {

/// /legend/{layers}.json, or /legend/{layers}[@2x].png, in the style of the query: for each layer,
/// topmost first, its title and one entry for each way in which its polygons are drawn. The picture
/// shows a small polygon for each, with pattern and outline as in the map, but with outlines of at
/// most 4 pixels.
Result<Document> legend_document(const DocumentRequest& request);

/// The size of the picture at scale 1, in pixels.
struct LegendSize {
  int width = 0;
  int height = 0;
};
/// The problem is an unknown layer, or a style in the query that does not fit it.
Result<LegendSize> legend_size(const std::string& layer, const DocumentRequest& request);

}  // namespace trapeze
