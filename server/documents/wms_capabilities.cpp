#include "server/documents/wms_capabilities.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>

#include "core/grid/web_mercator.h"
#include "render/mask/mask.h"
#include "render/picture/webp.h"
#include "server/base/nearest_name.h"
#include "server/base/xml_text.h"
#include "server/data/layer_summary.h"
#include "server/documents/catalog.h"
#include "server/documents/legend.h"
#include "server/tiles/tile_matrix_set.h"

namespace trapeze {
namespace {

constexpr std::string_view kCapabilitiesHead130 =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<WMS_Capabilities version="1.3.0" xmlns="http://www.opengis.net/wms"
 xmlns:sld="http://www.opengis.net/sld" xmlns:xlink="http://www.w3.org/1999/xlink"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xsi:schemaLocation="http://www.opengis.net/wms http://schemas.opengis.net/wms/1.3.0/capabilities_1_3_0.xsd http://www.opengis.net/sld http://schemas.opengis.net/sld/1.1.0/sld_capabilities.xsd">
)";

constexpr std::string_view kCapabilitiesHead111 =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<!DOCTYPE WMT_MS_Capabilities SYSTEM "http://schemas.opengis.net/wms/1.1.1/WMS_MS_Capabilities.dtd">
<WMT_MS_Capabilities version="1.1.1">
)";

double scale_denominator_of(int zoom) {
  return web_mercator_quad()->matrices[static_cast<std::size_t>(zoom)].scale_denominator;
}

/// Writes the document in one of the versions, which differ mainly in names.
class CapabilitiesWriter {
 public:
  CapabilitiesWriter(const WmsCapabilitiesRequest& asked, const DocumentRequest& request)
      : is_new_(asked.version == WmsVersion::v1_3_0), query_(asked.query), request_(request) {}

  std::string write() {
    xml_ = is_new_ ? kCapabilitiesHead130 : kCapabilitiesHead111;
    add_service();
    xml_ += "  <Capability>\n";
    add_requests();
    add_exceptions();
    add_layers();
    xml_ += "  </Capability>\n";
    xml_ += is_new_ ? "</WMS_Capabilities>\n" : "</WMT_MS_Capabilities>\n";
    return std::move(xml_);
  }

 private:
  std::string link(const std::string& address) const {
    // In the old version, every element with a link declares the namespace.
    return fmt::format(R"(<OnlineResource{} xlink:type="simple" xlink:href="{}"/>)",
                       is_new_ ? "" : R"( xmlns:xlink="http://www.w3.org/1999/xlink")",
                       xml_escape(address));
  }

  void add_service() {
    xml_ += fmt::format(
        R"(  <Service>
    <Name>{}</Name>
    <Title>Trapeze</Title>
    <Abstract>Maps of polygons, simplified while they are drawn</Abstract>
    {}
)",
        is_new_ ? "WMS" : "OGC:WMS", link(request_.base_url + "/"));
    if (is_new_) {
      const auto side = static_cast<int>(std::sqrt(static_cast<double>(request_.map_pixels)));
      xml_ += fmt::format(
          "    <LayerLimit>{0}</LayerLimit>\n    <MaxWidth>{1}</MaxWidth>\n"
          "    <MaxHeight>{1}</MaxHeight>\n",
          request_.max_layers, std::min(side, kMaxPicturePixels));
    }
    xml_ += "  </Service>\n";
  }

  void add_request(std::string_view name, std::span<const std::string_view> formats) {
    xml_ += fmt::format("      <{}>\n", name);
    for (const std::string_view format : formats) {
      xml_ += fmt::format("        <Format>{}</Format>\n", format);
    }
    xml_ += fmt::format("        <DCPType><HTTP><Get>{}</Get></HTTP></DCPType>\n      </{}>\n",
                        link(request_.base_url + "/wms?" + query_), name);
  }

  void add_requests() {
    xml_ += "    <Request>\n";
    const std::string_view capabilities = is_new_ ? "text/xml" : "application/vnd.ogc.wms_xml";
    add_request("GetCapabilities", {&capabilities, 1});
    std::vector<std::string_view> maps = {kWmsPng};
    if (has_webp()) maps.push_back(kWmsWebp);
    add_request("GetMap", maps);
    std::vector<std::string_view> infos;
    for (const InfoFormat& format : info_formats()) infos.push_back(format.name);
    add_request("GetFeatureInfo", infos);
    add_request(is_new_ ? "sld:GetLegendGraphic" : "GetLegendGraphic", {&kWmsPng, 1});
    xml_ += "    </Request>\n";
  }

  void add_exceptions() {
    xml_ += "    <Exception>\n";
    for (const std::string_view format : {"XML", "INIMAGE", "BLANK"}) {
      xml_ += is_new_ ? fmt::format("      <Format>{}</Format>\n", format)
                      : fmt::format("      <Format>application/vnd.ogc.se_{}</Format>\n",
                                    in_lower_case(format));
    }
    xml_ += "    </Exception>\n";
  }

  void add_layers() {
    xml_ += "    <Layer>\n      <Title>Trapeze</Title>\n";
    for (const MapSystemPtr& system : map_systems_of(request_.dataset)) {
      if (!is_for_all_layers(*system)) continue;
      add_system(system->name);
      if (system != web_mercator()) continue;
      for (const std::string& name : system->other_names) add_system(name);
    }
    Box all;
    for (const ServedLayer& served : request_.dataset.layers()) {
      if (!served.layer->bounds().is_empty()) all.include(served.layer->bounds());
    }
    add_bounds(all, "      ");
    for (const MapSystemPtr& system : usual_map_systems()) add_bounds_in(*system, all, "      ");
    for (const ServedLayer& served : request_.dataset.layers()) add_layer(served);
    xml_ += "    </Layer>\n";
  }

  bool is_for_all_layers(const MapSystem& system) const {
    return std::ranges::all_of(request_.dataset.layers(), [&](const ServedLayer& served) {
      return served_in(request_.dataset, served.config.name, system) != nullptr;
    });
  }

  void add_system(std::string_view name) {
    xml_ += fmt::format("      <{0}>{1}</{0}>\n", crs_element(), name);
  }

  std::string_view crs_element() const { return is_new_ ? "CRS" : "SRS"; }

  void add_bounds(const Box& box, std::string_view indent) {
    const Box some = box.is_empty() ? Box{kGridMin, kGridMin, kGridMax, kGridMax} : box;
    const auto [west, south, east, north] = bounds_in_degrees(some);
    xml_ += is_new_
                ? fmt::format(R"({0}<EX_GeographicBoundingBox>
{0}  <westBoundLongitude>{1}</westBoundLongitude>
{0}  <eastBoundLongitude>{3}</eastBoundLongitude>
{0}  <southBoundLatitude>{2}</southBoundLatitude>
{0}  <northBoundLatitude>{4}</northBoundLatitude>
{0}</EX_GeographicBoundingBox>
)",
                              indent, west, south, east, north)
                : fmt::format(
                      "{}<LatLonBoundingBox minx=\"{}\" miny=\"{}\" maxx=\"{}\" maxy=\"{}\"/>\n",
                      indent, west, south, east, north);
  }

  /// In degrees, the same numbers as in the geographic bounds.
  static SystemBounds bounds_of(const Box& box, const MapSystem& system) {
    if (!system.is_in_degrees) return system.bounds_of(box);
    const auto [west, south, east, north] = bounds_in_degrees(box);
    return {west, south, east, north};
  }

  /// In the axis order of GetMap in that version.
  void add_bounds_in(const MapSystem& system, const Box& box, std::string_view indent) {
    const Box some = box.is_empty() ? Box{kGridMin, kGridMin, kGridMax, kGridMax} : box;
    SystemBounds bounds = bounds_of(some, system);
    if (is_new_ && system.is_north_first) {
      bounds = {bounds.south, bounds.west, bounds.north, bounds.east};
    }
    xml_ += fmt::format(
        "{0}<BoundingBox {1}=\"{2}\" minx=\"{3:.{7}f}\" miny=\"{4:.{7}f}\" "
        "maxx=\"{5:.{7}f}\" maxy=\"{6:.{7}f}\"/>\n",
        indent, crs_element(), system.name, bounds.west, bounds.south, bounds.east, bounds.north,
        system.is_in_degrees ? 8 : 3);
  }

  void add_layer(const ServedLayer& served) {
    const LayerConfig& config = served.config;
    xml_ += fmt::format("      <Layer queryable=\"1\">\n        <Name>{}</Name>\n", config.name);
    xml_ += fmt::format("        <Title>{}</Title>\n", xml_escape(config.title));
    if (!config.description.empty()) {
      xml_ += fmt::format("        <Abstract>{}</Abstract>\n", xml_escape(config.description));
    }
    // Systems in which all layers can be drawn are listed above them.
    const auto systems = map_systems_of(request_.dataset, config.name);
    for (const MapSystemPtr& system : systems) {
      if (!is_for_all_layers(*system)) add_system(system->name);
    }
    add_bounds(served.layer->bounds(), "        ");
    for (const MapSystemPtr& system : systems) {
      const ServedLayer* there = served_in(request_.dataset, config.name, *system);
      if (there != nullptr) add_bounds_in(*system, there->layer->bounds(), "        ");
    }
    const std::string attribution =
        attribution_of(config.attribution, {&config.name, 1}, StyleQuery(), request_.dataset);
    if (!attribution.empty()) {
      xml_ += fmt::format("        <Attribution><Title>{}</Title></Attribution>\n",
                          xml_escape(attribution));
    }
    add_style(config.name, std::string(StyleBook::kDefaultName), {});
    for (const std::string& style : request_.styles.names()) {
      add_style(config.name, style, {{"style", style}});
    }
    add_scales(config);
    xml_ += "      </Layer>\n";
  }

  /// Only if the style fits the layer.
  void add_style(const std::string& layer, const std::string& style, std::vector<QueryPair> query) {
    DocumentRequest legend = request_;
    legend.query = std::move(query);
    const auto size = legend_size(layer, legend);
    if (!size) return;
    const std::string address = fmt::format("{}/legend/{}.png{}", request_.base_url, layer,
                                            legend.query.empty() ? "" : "?style=" + style);
    xml_ += fmt::format(R"(        <Style>
          <Name>{0}</Name>
          <Title>{0}</Title>
          <LegendURL width="{1}" height="{2}">
            <Format>{3}</Format>
            {4}
          </LegendURL>
        </Style>
)",
                        style, size->width, size->height, kWmsPng, link(address));
  }

  /// A layer is drawn from its first zoom on, up to the zoom after its last; maps beyond the last
  /// zoom of all are refused.
  void add_scales(const LayerConfig& config) {
    const bool has_most = config.min_zoom > 0;
    const double least = scale_denominator_of(
        std::max(config.min_zoom, std::min(config.max_zoom + 1, request_.max_zoom)));
    const double most = scale_denominator_of(config.min_zoom);
    if (is_new_) {
      xml_ += fmt::format("        <MinScaleDenominator>{}</MinScaleDenominator>\n", least);
      if (has_most)
        xml_ += fmt::format("        <MaxScaleDenominator>{}</MaxScaleDenominator>\n", most);
    } else {
      // Diagonals of pixels on the ground.
      const double metres = kMetresPerPixel * std::numbers::sqrt2;
      xml_ += fmt::format("        <ScaleHint min=\"{}\" max=\"{}\"/>\n", least * metres,
                          has_most ? most * metres : 1e9);
    }
  }

  const bool is_new_;
  const std::string& query_;
  const DocumentRequest& request_;
  std::string xml_;
};

}  // namespace

Document wms_capabilities(const WmsCapabilitiesRequest& asked, const DocumentRequest& request) {
  const bool is_new = asked.version == WmsVersion::v1_3_0;
  return {is_new ? "text/xml" : "application/vnd.ogc.wms_xml",
          CapabilitiesWriter(asked, request).write()};
}

}  // namespace trapeze
