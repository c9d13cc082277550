#include "server/documents/wmts.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include "core/grid/web_mercator.h"
#include "render/mask/mask.h"
#include "server/base/nearest_name.h"
#include "server/base/xml_text.h"
#include "server/data/layer_summary.h"
#include "server/documents/tile_matrix_set.h"

namespace trapeze {
namespace {

constexpr std::string_view kFormat = "image/png";

constexpr std::string_view kHead =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Capabilities xmlns="http://www.opengis.net/wmts/1.0" xmlns:ows="http://www.opengis.net/ows/1.1"
 xmlns:xlink="http://www.w3.org/1999/xlink" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xsi:schemaLocation="http://www.opengis.net/wmts/1.0 http://schemas.opengis.net/wmts/1.0/wmtsGetCapabilities_response.xsd"
 version="1.0.0">
  <ows:ServiceIdentification>
    <ows:Title>Trapeze</ows:Title>
    <ows:Abstract>Maps of polygons as tiles, simplified while they are drawn</ows:Abstract>
    <ows:ServiceType>OGC WMTS</ows:ServiceType>
    <ows:ServiceTypeVersion>1.0.0</ows:ServiceTypeVersion>
  </ows:ServiceIdentification>
)";

std::string operation_xml(std::string_view name, const std::string& base_url) {
  return fmt::format(R"(    <ows:Operation name="{0}">
      <ows:DCP><ows:HTTP>
        <ows:Get xlink:href="{1}/wmts?">
          <ows:Constraint name="GetEncoding">
            <ows:AllowedValues><ows:Value>KVP</ows:Value></ows:AllowedValues>
          </ows:Constraint>
        </ows:Get>
      </ows:HTTP></ows:DCP>
    </ows:Operation>
)",
                     name, xml_escape(base_url));
}

std::string limits_xml(const LayerConfig& config, const Box& box) {
  std::string xml = "        <TileMatrixSetLimits>\n";
  const Box world{kGridMin, kGridMin, kGridMax, kGridMax};
  for (int zoom = config.min_zoom; zoom <= config.max_zoom; ++zoom) {
    const TileLimits limits = tile_limits(box.is_empty() ? world : box, zoom);
    xml += fmt::format(
        "          <TileMatrixLimits><TileMatrix>{}</TileMatrix><MinTileRow>{}</MinTileRow>"
        "<MaxTileRow>{}</MaxTileRow><MinTileCol>{}</MinTileCol><MaxTileCol>{}</MaxTileCol>"
        "</TileMatrixLimits>\n",
        zoom, limits.min_row, limits.max_row, limits.min_column, limits.max_column);
  }
  return xml + "        </TileMatrixSetLimits>\n";
}

std::string style_xml(const std::string& layer, std::string_view style,
                      const std::string& base_url) {
  const bool is_default = style == StyleBook::kDefaultName;
  return fmt::format(R"(      <Style isDefault="{}">
        <ows:Identifier>{}</ows:Identifier>
        <LegendURL format="{}" xlink:href="{}/legend/{}.png{}"/>
      </Style>
)",
                     is_default, style, kFormat, xml_escape(base_url), layer,
                     is_default ? "" : fmt::format("?style={}", style));
}

std::string layer_xml(const ServedLayer& served, const DocumentRequest& request) {
  const std::string& base_url = request.base_url;
  const LayerConfig& config = served.config;
  const Box& box = served.layer->bounds();
  const auto [west, south, east, north] = box.is_empty() ? kWorldBounds : bounds_in_degrees(box);
  std::string xml = "    <Layer>\n";
  xml += fmt::format("      <ows:Title>{}</ows:Title>\n", xml_escape(config.title));
  if (!config.description.empty()) {
    xml += fmt::format("      <ows:Abstract>{}</ows:Abstract>\n", xml_escape(config.description));
  }
  xml += fmt::format(R"(      <ows:WGS84BoundingBox>
        <ows:LowerCorner>{} {}</ows:LowerCorner>
        <ows:UpperCorner>{} {}</ows:UpperCorner>
      </ows:WGS84BoundingBox>
      <ows:Identifier>{}</ows:Identifier>
)",
                     west, south, east, north, config.name);
  xml += style_xml(config.name, StyleBook::kDefaultName, base_url);
  for (const std::string& style : request.styles.names()) {
    xml += style_xml(config.name, style, base_url);
  }
  xml += fmt::format(R"(      <Format>{}</Format>
      <TileMatrixSetLink>
        <TileMatrixSet>{}</TileMatrixSet>
)",
                     kFormat, kTileMatrixSet);
  xml += limits_xml(config, box);
  xml += fmt::format(R"(      </TileMatrixSetLink>
      <ResourceURL format="{}" resourceType="tile"
       template="{}/tiles/{}/s/{{Style}}/{{TileMatrix}}/{{TileCol}}/{{TileRow}}.png"/>
    </Layer>
)",
                     kFormat, xml_escape(base_url), config.name);
  return xml;
}

std::string matrix_set_xml() {
  std::string xml = fmt::format(R"(    <TileMatrixSet>
      <ows:Title>{}</ows:Title>
      <ows:Identifier>{}</ows:Identifier>
      <ows:SupportedCRS>urn:ogc:def:crs:EPSG::3857</ows:SupportedCRS>
      <WellKnownScaleSet>urn:ogc:def:wkss:OGC:1.0:GoogleMapsCompatible</WellKnownScaleSet>
)",
                                kTileMatrixSetTitle, kTileMatrixSet);
  for (int zoom = 0; zoom <= kMaxZoom; ++zoom) {
    xml += fmt::format(R"(      <TileMatrix>
        <ows:Identifier>{0}</ows:Identifier>
        <ScaleDenominator>{1}</ScaleDenominator>
        <TopLeftCorner>-{2} {2}</TopLeftCorner>
        <TileWidth>{3}</TileWidth>
        <TileHeight>{3}</TileHeight>
        <MatrixWidth>{4}</MatrixWidth>
        <MatrixHeight>{4}</MatrixHeight>
      </TileMatrix>
)",
                       zoom, scale_denominator(zoom), kMercatorHalfSide, kTilePixels, 1 << zoom);
  }
  return xml + "    </TileMatrixSet>\n";
}

std::string capabilities_xml(const DocumentRequest& request) {
  std::string xml(kHead);
  xml += "  <ows:OperationsMetadata>\n" + operation_xml("GetCapabilities", request.base_url) +
         operation_xml("GetTile", request.base_url) + "  </ows:OperationsMetadata>\n  <Contents>\n";
  for (const ServedLayer& served : request.dataset.layers()) {
    xml += layer_xml(served, request);
  }
  xml += matrix_set_xml() + "  </Contents>\n";
  xml += fmt::format("  <ServiceMetadataURL xlink:href=\"{}/wmts.xml\"/>\n</Capabilities>\n",
                     xml_escape(request.base_url));
  return xml;
}

// The keys of GetTile, in any case of letters. What else stands in the query is about style.
constexpr std::array<std::string_view, 10> kKeys = {
    "service", "request",       "version",    "layer",   "style",
    "format",  "tilematrixset", "tilematrix", "tilerow", "tilecol",
};

/// A query, divided.
struct KeyValuePairs {
  std::array<std::string, kKeys.size()> values;
  std::vector<QueryPair> others;

  const std::string& operator[](std::string_view key) const {
    return values[static_cast<std::size_t>(std::ranges::find(kKeys, key) - kKeys.begin())];
  }
};

KeyValuePairs divide(std::span<const QueryPair> query) {
  KeyValuePairs pairs;
  for (const auto& [name, value] : query) {
    const auto key = std::ranges::find(kKeys, in_lower_case(name));
    if (key == kKeys.end()) {
      pairs.others.emplace_back(name, value);
    } else {
      pairs.values[static_cast<std::size_t>(key - kKeys.begin())] = value;
    }
  }
  return pairs;
}

bool is_key_value_path(const DocumentRequest& request) {
  return request.path.size() == 1 && request.path[0] == "wmts";
}

/// A key whose value must be the one given, or may be left out.
std::optional<Problem> check(const KeyValuePairs& pairs, std::string_view key,
                             std::string_view value) {
  if (pairs[key].empty() || in_lower_case(pairs[key]) == in_lower_case(value)) return std::nullopt;
  return Problem{400, fmt::format("{} takes {} here.", key, value), std::string(key), pairs[key],
                 std::string(value)};
}

Result<TileRequest> tile_of(const KeyValuePairs& pairs, const StyleBook& styles) {
  for (const auto& [key, value] :
       std::initializer_list<std::pair<std::string_view, std::string_view>>{
           {"service", "WMTS"},
           {"version", "1.0.0"},
           {"format", kFormat},
           {"tilematrixset", kTileMatrixSet}}) {
    if (auto problem = check(pairs, key, value)) return std::move(*problem);
  }
  auto layers = parse_layer_list(pairs["layer"]);
  if (!layers) return std::move(layers).problem();
  const auto tile = parse_tile_id(pairs["tilematrix"], pairs["tilecol"], pairs["tilerow"]);
  if (!tile) return tile.problem();
  TileRequest request{*std::move(layers), *tile, 1, {}};
  std::vector<QueryPair> query = pairs.others;
  if (!pairs["style"].empty()) query.emplace_back("style", pairs["style"]);
  const auto styled = styles.read(std::move(query));
  if (!styled) return styled.problem();
  auto style = styled->style_for(request.layers);
  if (!style) return std::move(style).problem();
  request.style = *std::move(style);
  return request;
}

}  // namespace

Result<Document> wmts_document(const DocumentRequest& request) {
  if (request.path.size() != 1) {
    return Problem{404, "There is nothing here. The capabilities are at /wmts.xml."};
  }
  if (is_key_value_path(request)) {
    const KeyValuePairs pairs = divide(request.query);
    if (auto problem = check(pairs, "service", "WMTS")) return std::move(*problem);
    if (in_lower_case(pairs["request"]) != "getcapabilities") {
      return Problem{400, "request takes GetCapabilities or GetTile.", "request", pairs["request"],
                     "GetCapabilities or GetTile"};
    }
  }
  return Document{"application/xml", capabilities_xml(request)};
}

std::optional<Result<TileRequest>> parse_wmts_tile(const DocumentRequest& request) {
  if (!is_key_value_path(request)) return std::nullopt;
  const KeyValuePairs pairs = divide(request.query);
  if (in_lower_case(pairs["request"]) != "gettile") return std::nullopt;
  return tile_of(pairs, request.styles);
}

}  // namespace trapeze
