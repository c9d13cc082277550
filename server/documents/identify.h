// Which features lie under a place on the map, with their attributes as they stand in the source.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid/grid.h"
#include "server/base/result.h"
#include "server/data/dataset.h"
#include "server/documents/document.h"
#include "server/styles/style_parameters.h"
#include "server/tiles/map_system.h"

namespace trapeze {

constexpr std::size_t kMaxIdentified = 100;                        // features in one answer
constexpr std::size_t kMaxIdentifiedBytes = std::size_t{4} << 20;  // of their attributes, as JSON

/// What lies under a place of the map.
struct PlaceQuery {
  std::vector<std::string> layers;  // bottom first
  Point place;
  std::optional<double> zoom;  // nothing: by the true polygons
  StyleQuery style;
  std::size_t most_of_layer = std::numeric_limits<std::size_t>::max();  // features
  MapSystemPtr system = web_mercator();  // on whose grid the place is
};

enum class IdentifyFormat : std::uint8_t { json, text, html };

/// The media types that the services of the OGC have features in, and the endings of their
/// addresses.
struct InfoFormat {
  std::string_view name;
  std::string_view ending;  // empty: by key-value pairs only
  std::string_view content_type;
  IdentifyFormat format;
};
std::span<const InfoFormat> info_formats();

/// The features under the place, as those of identify_document(), in words for a reader, or as a
/// page of HTML with them.
Result<std::string> identified_features(const PlaceQuery& query, const Dataset& dataset,
                                        IdentifyFormat format);

/// /identify/{layers}/{lon},{lat}?z=: a GeoJSON FeatureCollection of the features under the place,
/// those of the topmost layer first, each with its layer, source id, title, bounds and attributes,
/// but without its geometry; "part_bbox" has the bounds of the part under the place, of a feature
/// that reaches beyond them. With z, 0 to 24 and not only whole, by the polygons as they are drawn
/// at that zoom, `simplify` included; without it by the true ones. A feature whose attributes would
/// make the answer too long has null in their place; "propertiesLeftOut" is how many these are.
Result<Document> identify_document(const DocumentRequest& request);

}  // namespace trapeze
