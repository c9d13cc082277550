// Which features lie under a place on the map, with their attributes as they stand in the source.
#pragma once

#include "server/base/result.h"
#include "server/documents/document.h"

namespace trapeze {

constexpr std::size_t kMaxIdentified = 100;                        // features in one answer
constexpr std::size_t kMaxIdentifiedBytes = std::size_t{4} << 20;  // of their attributes, as JSON

/// /identify/{layers}/{lon},{lat}?z=: a GeoJSON FeatureCollection of the features under the place,
/// those of the topmost layer first, each with its layer, source id, bounds and attributes, but
/// without its geometry. With z, 0 to 24 and not only whole, by the polygons as they are drawn at
/// that zoom, `simplify` included; without it by the true ones. A feature whose attributes would
/// make the answer too long has null in their place; "propertiesLeftOut" is how many these are.
Result<Document> identify_document(const DocumentRequest& request);

}  // namespace trapeze
