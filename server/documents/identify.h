// Finds the features at a place on the map, with their attributes as in the source.
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

/// A query for the features at a place on the map.
struct PlaceQuery {
  std::vector<std::string> layers;  // bottom first
  Point place;
  std::optional<double> zoom;  // nothing: the unsimplified polygons are used
  StyleQuery style;
  std::size_t most_of_layer = std::numeric_limits<std::size_t>::max();  // features per layer
  MapSystemPtr system = web_mercator();  // on whose grid the place is
};

enum class IdentifyFormat : std::uint8_t { json, text, html };

/// The media types of features in OGC services, and the corresponding file name extensions in URLs.
struct InfoFormat {
  std::string_view name;
  std::string_view ending;  // empty: with key-value pairs only
  std::string_view content_type;
  IdentifyFormat format;
};
std::span<const InfoFormat> info_formats();

/// The features at the place, as in identify_document(), as plain text or as an HTML page.
Result<std::string> identified_features(const PlaceQuery& query, const Dataset& dataset,
                                        IdentifyFormat format);

/// /identify/{layers}/{lon},{lat}?z=: a GeoJSON FeatureCollection of the features at the place,
/// topmost layer first, each with its layer, source id, title, bounds and attributes, but without
/// geometry. "part_bbox" has the bounds of the part at the place, for a feature that extends beyond
/// them. With z, from 0 to 24 and possibly fractional, the polygons as drawn at that zoom are used,
/// including `simplify`; without it the unsimplified ones. If the attributes of a feature would
/// make the answer too long, they are null; "propertiesLeftOut" counts these features.
Result<Document> identify_document(const DocumentRequest& request);

}  // namespace trapeze
