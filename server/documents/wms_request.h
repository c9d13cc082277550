// Requests to WMS 1.3.0 and 1.1.1, as key-value pairs at /wms; keys ignore case. Version 1.3.0 uses
// the axis order of a reference system's authority, so boxes in EPSG:4326 begin with latitudes;
// 1.1.1 always has eastings first.
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
/// Pixels per inch at which lines are as wide as in tiles; also what QGIS assumes for a screen.
constexpr double kUsualDpi = 96;

struct WmsCapabilitiesRequest {
  WmsVersion version = WmsVersion::v1_3_0;
  std::string query = {};  // style parameters to be kept in URLs: "fill=teal&", encoded
};

/// A query for the features at a pixel of a map.
struct WmsFeatureInfoRequest {
  PlaceQuery query;
  IdentifyFormat format = IdentifyFormat::json;
  std::string content_type;
};

/// /legend/{file} in the style of the query, which `named` completes.
struct WmsLegendRequest {
  std::string file;
  std::vector<QueryPair> query;
  std::shared_ptr<const StyleQuery> named = {};  // null: none
};

using WmsRequest =
    std::variant<WmsCapabilitiesRequest, WindowRequest, WmsFeatureInfoRequest, WmsLegendRequest>;

/// How problems are reported.
enum class WmsExceptions : std::uint8_t { xml, in_image, blank };

/// The parts of a query that determine error reports and the picture, as far as they are valid.
struct WmsExceptionRequest {
  WmsVersion version = WmsVersion::v1_3_0;
  WmsExceptions exceptions = WmsExceptions::xml;
  int width = 0;  // 0: missing or invalid
  int height = 0;
  TileFormat format = TileFormat::png;
  Rgba background;
};

/// The problem has a WMS code and the parameter name of WMS; its status is 400, 404 or 501. Other
/// pairs of the query style the map; pairs that do not resemble a style parameter are ignored, as
/// the standard requires.
Result<WmsRequest> parse_wms_request(const DocumentRequest& request);

WmsExceptionRequest parse_wms_exceptions(std::span<const QueryPair> query);

}  // namespace trapeze
