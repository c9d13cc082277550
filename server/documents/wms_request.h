// What is asked of WMS 1.3.0 and 1.1.1, by key-value pairs at /wms, where keys may be written in
// any case of letters. Version 1.3.0 has the axes of a reference system in the order of its
// authority, so that boxes of EPSG:4326 begin with latitudes, and 1.1.1 has eastings first always.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/base/result.h"
#include "server/documents/document.h"
#include "server/documents/identify.h"
#include "server/tiles/window_request.h"

namespace trapeze {

enum class WmsVersion : std::uint8_t { v1_1_1, v1_3_0 };

/// "1.3.0".
std::string_view name_of(WmsVersion version);

constexpr std::string_view kWmsPng = "image/png";
constexpr std::string_view kWmsWebp = "image/webp";
/// Pixels to an inch where lines are as wide as in tiles, which is what QGIS takes a screen for.
constexpr double kUsualDpi = 96;

struct WmsCapabilitiesRequest {
  WmsVersion version = WmsVersion::v1_3_0;
  std::string query = {};  // about style, to be kept in addresses: "fill=teal&", encoded
};

/// What lies under a pixel of a map.
struct WmsFeatureInfoRequest {
  PlaceQuery query;
  IdentifyFormat format = IdentifyFormat::json;
  std::string content_type;
};

/// /legend/{file} in the style of the query.
struct WmsLegendRequest {
  std::string file;
  std::vector<QueryPair> query;
};

using WmsRequest =
    std::variant<WmsCapabilitiesRequest, WindowRequest, WmsFeatureInfoRequest, WmsLegendRequest>;

/// How what is wrong is to be told.
enum class WmsExceptions : std::uint8_t { xml, in_image, blank };

/// What a query says of that and of the picture, as far as it can be understood.
struct WmsExceptionRequest {
  WmsVersion version = WmsVersion::v1_3_0;
  WmsExceptions exceptions = WmsExceptions::xml;
  int width = 0;  // 0: not understood
  int height = 0;
  TileFormat format = TileFormat::png;
  Rgba background;
};

/// The problem has a code of WMS and the parameter as it calls it; 400, 404 or 501. Other pairs of
/// the query style the map; those that have no likeness to a parameter of styles are passed over,
/// as the standard wants it.
Result<WmsRequest> parse_wms_request(const DocumentRequest& request);

WmsExceptionRequest parse_wms_exceptions(std::span<const QueryPair> query);

}  // namespace trapeze
