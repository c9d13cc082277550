#include "server/data/layer_summary.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "server/base/nearest_name.h"

namespace trapeze {
namespace {

void add_once(std::vector<std::string>& texts, const std::string& text) {
  if (text.empty() || std::ranges::find(texts, text) != texts.end()) return;
  texts.push_back(text);
}

std::string joined(const std::vector<std::string>& texts) {
  return fmt::format("{}", fmt::join(texts, ", "));
}

}  // namespace

double round_degrees(double degrees) {
  return std::round(degrees * 1e7) / 1e7;
}

GeographicBounds bounds_in_degrees(const Box& box) {
  const LonLat north_west = lonlat_from_grid(box.min_x, box.min_y);
  const LonLat south_east = lonlat_from_grid(box.max_x, box.max_y);
  return {round_degrees(north_west.lon), round_degrees(south_east.lat),
          round_degrees(south_east.lon), round_degrees(north_west.lat)};
}

GeographicBounds LayerSummary::bounds() const {
  return box.is_empty() ? kWorldBounds : bounds_in_degrees(box);
}

Result<LayerSummary> summarize_layers(std::span<const std::string> names, const Dataset& dataset) {
  LayerSummary summary;
  std::vector<std::string> titles;
  std::vector<std::string> descriptions;
  std::vector<std::string> attributions;
  for (const std::string& name : names) {
    const auto position = dataset.find(name);
    if (!position) return unknown_layer(name, dataset);
    const ServedLayer& served = dataset.layers()[*position];
    add_once(titles, served.config.title);
    add_once(descriptions, served.config.description);
    add_once(attributions, served.config.attribution);
    summary.box.include(served.layer->bounds());
    summary.min_zoom = std::min(summary.min_zoom, served.config.min_zoom);
    summary.max_zoom = std::max(summary.max_zoom, served.config.max_zoom);
    if (const auto& detail = served.config.detail_zoom) {
      summary.detail_zoom = std::min(summary.detail_zoom.value_or(kMaxZoom), *detail);
    }
  }
  summary.title = joined(titles);
  summary.description = joined(descriptions);
  summary.attribution = joined(attributions);
  return summary;
}

Problem unknown_layer(const std::string& name, const Dataset& dataset) {
  constexpr std::size_t kMaxNames = 20;
  std::vector<std::string> known;
  for (const ServedLayer& served : dataset.layers()) known.push_back(served.config.name);
  const auto shown = std::span(known).first(std::min(known.size(), kMaxNames));
  return {404, fmt::format("There is no layer \"{}\"{}", name, suggestion_or_stop(name, known)),
          "layers", name,
          fmt::format("one of {}{}", fmt::join(shown, ", "),
                      known.size() > kMaxNames ? ", ... (all are in /catalog)" : "")};
}

}  // namespace trapeze
