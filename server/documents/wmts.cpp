#include "server/documents/wmts.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "core/grid/web_mercator.h"
#include "render/mask/mask.h"
#include "server/base/xml_text.h"
#include "server/data/layer_summary.h"
#include "server/documents/identify.h"
#include "server/documents/wmts_request.h"
#include "server/tiles/tile_matrix_set.h"

namespace trapeze {
namespace {

constexpr std::string_view kHead =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Capabilities xmlns="http://www.opengis.net/wmts/1.0" xmlns:ows="http://www.opengis.net/ows/1.1"
 xmlns:xlink="http://www.w3.org/1999/xlink" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xsi:schemaLocation="http://www.opengis.net/wmts/1.0 http://schemas.opengis.net/wmts/1.0/wmtsGetCapabilities_response.xsd"
 version="1.0.0">
)";

constexpr std::string_view kIdentification =
    R"(  <ows:ServiceIdentification>
    <ows:Title>Trapeze</ows:Title>
    <ows:Abstract>Maps of polygons as tiles, simplified while they are drawn</ows:Abstract>
    <ows:ServiceType>OGC WMTS</ows:ServiceType>
    <ows:ServiceTypeVersion>1.0.0</ows:ServiceTypeVersion>
  </ows:ServiceIdentification>
)";

constexpr std::string_view kGetCapabilities = "GetCapabilities";
constexpr std::array<std::string_view, 3> kOperationNames = {kGetCapabilities, "GetTile",
                                                             "GetFeatureInfo"};
// For GetCapabilities.
constexpr std::string_view kFormats =
    R"(      <ows:Parameter name="AcceptFormats">
        <ows:AllowedValues><ows:Value>application/xml</ows:Value></ows:AllowedValues>
      </ows:Parameter>
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
{2}    </ows:Operation>
)",
                     name, xml_escape(base_url), name == kGetCapabilities ? kFormats : "");
}

std::string limits_xml(const ServedLayer& served, const TileMatrixSet& set, double margin) {
  std::string xml = "        <TileMatrixSetLimits>\n";
  for (std::size_t i = 0; i < set.matrices.size(); ++i) {
    if (!has_tiles_of(served, set.matrices[i])) continue;
    const TileLimits limits = wmts_limits(served, set, i, margin);
    xml += fmt::format(
        "          <TileMatrixLimits><TileMatrix>{}</TileMatrix><MinTileRow>{}</MinTileRow>"
        "<MaxTileRow>{}</MaxTileRow><MinTileCol>{}</MinTileCol><MaxTileCol>{}</MaxTileCol>"
        "</TileMatrixLimits>\n",
        xml_escape(set.matrices[i].id), limits.min_row, limits.max_row, limits.min_column,
        limits.max_column);
  }
  return xml + "        </TileMatrixSetLimits>\n";
}

/// At one of its scales at least.
bool is_drawn_in(const ServedLayer& served, const TileMatrixSet& set) {
  return std::ranges::any_of(
      set.matrices, [&served](const TileMatrix& matrix) { return has_tiles_of(served, matrix); });
}

std::string style_xml(const std::string& layer, std::string_view style,
                      const std::string& base_url) {
  const bool is_default = style == StyleBook::kDefaultName;
  // OpenLayers finds a style by its title, and uses the first one if no title matches.
  return fmt::format(R"(      <Style isDefault="{0}">
        <ows:Title>{1}</ows:Title>
        <ows:Identifier>{1}</ows:Identifier>
        <LegendURL format="{2}" xlink:href="{3}/legend/{4}.png{5}"/>
      </Style>
)",
                     is_default, style, kWmtsFormat, xml_escape(base_url), layer,
                     is_default ? "" : fmt::format("?style={}", style));
}

std::string resource_xml(std::string_view format, std::string_view type,
                         const std::string& address) {
  return fmt::format(R"(      <ResourceURL format="{}" resourceType="{}"
       template="{}"/>
)",
                     format, type, xml_escape(address));
}

/// The bounds in the systems of other planes, in the axis order of the authority: their sides are
/// curves in degrees, so that clients cannot compute them from the bounds there.
std::string plane_bounds_xml(const ServedLayer& served, const DocumentRequest& request) {
  std::string xml;
  for (const MapSystemPtr& system : map_systems_of(request.dataset, served.config.name)) {
    if (system->grid.empty()) continue;
    const ServedLayer* there = served_in(request.dataset, served.config.name, *system);
    if (there == nullptr || there->layer->bounds().is_empty()) continue;
    SystemBounds bounds = system->bounds_of(there->layer->bounds());
    if (system->is_north_first) bounds = {bounds.south, bounds.west, bounds.north, bounds.east};
    xml += fmt::format(R"(      <ows:BoundingBox crs="{}">
        <ows:LowerCorner>{:.3f} {:.3f}</ows:LowerCorner>
        <ows:UpperCorner>{:.3f} {:.3f}</ows:UpperCorner>
      </ows:BoundingBox>
)",
                       system->urn, bounds.west, bounds.south, bounds.east, bounds.north);
  }
  return xml;
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
  xml += plane_bounds_xml(served, request);
  xml += style_xml(config.name, StyleBook::kDefaultName, base_url);
  for (const std::string& style : request.styles.names()) {
    xml += style_xml(config.name, style, base_url);
  }
  xml += fmt::format("      <Format>{}</Format>\n", kWmtsFormat);
  for (const InfoFormat& format : info_formats()) {
    xml += fmt::format("      <InfoFormat>{}</InfoFormat>\n", format.name);
  }
  for (const TileMatrixSetPtr& set : wmts_sets(request)) {
    const ServedLayer* there = served_in(request.dataset, config.name, *set->system);
    if (there == nullptr || !is_drawn_in(served, *set)) continue;
    xml += fmt::format(R"(      <TileMatrixSetLink>
        <TileMatrixSet>{}</TileMatrixSet>
)",
                       set->id);
    xml += limits_xml(*there, *set, wmts_margin(*there, request.styles));
    xml += "      </TileMatrixSetLink>\n";
  }
  const std::string tile =
      fmt::format("{}/wmts/{}/{{Style}}/{{TileMatrixSet}}/{{TileMatrix}}/{{TileRow}}/{{TileCol}}",
                  base_url, config.name);
  xml += resource_xml(kWmtsFormat, "tile", tile + ".png");
  for (const InfoFormat& format : info_formats()) {
    if (format.ending.empty()) continue;
    xml += resource_xml(format.name, "FeatureInfo",
                        fmt::format("{}/{{J}}/{{I}}{}", tile, format.ending));
  }
  return xml + "    </Layer>\n";
}

/// The URI of a scale set in the form of WMTS 1.0.0:
/// "urn:ogc:def:wkss:OGC:1.0:GoogleMapsCompatible".
std::string urn_of_scale_set(const TileMatrixSet& set) {
  return fmt::format("urn:ogc:def:wkss:OGC:1.0:{}",
                     xml_escape(set.scale_set.substr(set.scale_set.rfind('/') + 1)));
}

std::string matrix_set_xml(const TileMatrixSet& set) {
  std::string xml = fmt::format(R"(    <TileMatrixSet>
      <ows:Title>{}</ows:Title>
      <ows:Identifier>{}</ows:Identifier>
      <ows:SupportedCRS>{}</ows:SupportedCRS>
)",
                                xml_escape(set.title), set.id, set.system->urn);
  if (!set.scale_set.empty()) {
    xml += fmt::format("      <WellKnownScaleSet>{}</WellKnownScaleSet>\n", urn_of_scale_set(set));
  }
  for (const TileMatrix& matrix : set.matrices) {
    const bool is_north_first = set.system->is_north_first;
    xml += fmt::format(R"(      <TileMatrix>
        <ows:Identifier>{}</ows:Identifier>
        <ScaleDenominator>{}</ScaleDenominator>
        <TopLeftCorner>{} {}</TopLeftCorner>
        <TileWidth>{}</TileWidth>
        <TileHeight>{}</TileHeight>
        <MatrixWidth>{}</MatrixWidth>
        <MatrixHeight>{}</MatrixHeight>
      </TileMatrix>
)",
                       xml_escape(matrix.id), matrix.scale_denominator,
                       is_north_first ? matrix.origin_y : matrix.west,
                       is_north_first ? matrix.west : matrix.origin_y, matrix.tile_width,
                       matrix.tile_height, matrix.width, matrix.height);
  }
  return xml + "    </TileMatrixSet>\n";
}

std::string capabilities_xml(const WmtsCapabilitiesRequest& sections,
                             const DocumentRequest& request) {
  std::string xml(kHead);
  if (sections.identification) xml += kIdentification;
  if (sections.operations) {
    xml += "  <ows:OperationsMetadata>\n";
    for (const std::string_view operation : kOperationNames) {
      xml += operation_xml(operation, request.base_url);
    }
    xml += "  </ows:OperationsMetadata>\n";
  }
  if (sections.contents) {
    xml += "  <Contents>\n";
    for (const ServedLayer& served : request.dataset.layers()) xml += layer_xml(served, request);
    for (const TileMatrixSetPtr& set : wmts_sets(request)) xml += matrix_set_xml(*set);
    xml += "  </Contents>\n";
  }
  xml += fmt::format("  <ServiceMetadataURL xlink:href=\"{}/wmts.xml\"/>\n</Capabilities>\n",
                     xml_escape(request.base_url));
  return xml;
}

}  // namespace

Result<Document> wmts_document(const DocumentRequest& request) {
  const auto parsed = parse_wmts_request(request);
  if (!parsed) return parsed.problem();
  const WmtsRequest& asked = *parsed;
  if (const auto* sections = std::get_if<WmtsCapabilitiesRequest>(&asked)) {
    return Document{"application/xml", capabilities_xml(*sections, request)};
  }
  const auto* info = std::get_if<WmtsFeatureInfoRequest>(&asked);
  if (info == nullptr) return Problem{400, "This is a tile."};
  auto text = identified_features(info->query, request.dataset, info->format);
  if (!text) return std::move(text).problem();
  return Document{info->content_type, *std::move(text)};
}

std::optional<Result<PictureRequest>> parse_wmts_tile(const DocumentRequest& request) {
  auto parsed = parse_wmts_request(request);
  if (!parsed) return Result<PictureRequest>(std::move(parsed).problem());
  WmtsRequest asked = *std::move(parsed);
  auto* tile = std::get_if<TileRequest>(&asked);
  if (tile == nullptr) return std::nullopt;
  return Result<PictureRequest>(std::move(*tile));
}

}  // namespace trapeze
