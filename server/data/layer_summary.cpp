#include "server/data/layer_summary.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/mesh/mesh_index.h"
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

// Longitudes, in parts of the width of the world, in which there is something.
class TakenLongitudes {
 public:
  void add(const Box& box) {
    for (std::size_t i = part_of(box.min_x); i <= part_of(box.max_x); ++i) taken_[i] = true;
  }

  /// All but the widest gap, which may begin in the east of the world and end in its west; nothing
  /// if there is none.
  std::optional<LongitudeStrip> strip() const {
    std::size_t gap_begin = 0;
    std::size_t widest = 0;
    std::size_t begin = 0;
    for (std::size_t i = 0; i < 2 * kParts; ++i) {
      if (taken_[i % kParts]) begin = i + 1;
      const std::size_t width = i + 1 - begin;
      if (width >= kParts) return std::nullopt;  // nothing is taken
      if (width > widest) {
        widest = width;
        gap_begin = begin;
      }
    }
    if (widest == 0) return std::nullopt;
    const std::size_t west = (gap_begin + widest) % kParts;
    return LongitudeStrip{degrees_of(west), degrees_of(west + kParts - widest)};
  }

 private:
  static constexpr std::size_t kParts = 4096;

  static std::size_t part_of(std::int64_t x) {
    const std::int64_t on_world = std::clamp<std::int64_t>(x, kGridMin, kGridMax - 1);
    return static_cast<std::size_t>((on_world - kGridMin) * std::int64_t{kParts} / kGridSize);
  }
  static double degrees_of(std::size_t part) {
    return static_cast<double>(part) * 360 / kParts - 180;
  }

  std::array<bool, kParts> taken_{};
};

/// As a tile of zoom 0 shows it.
void add_trapezoids(const Layer& layer, TakenLongitudes& taken) {
  const Level level = nearest_level(static_cast<double>(kGridSize) / kTilePixels / 4);
  std::vector<TrapezoidRange> ranges;
  layer.select({layer.bounds(), level, level, SmallPolygons::dust}, ranges);
  for_each_trapezoid(ranges, [&](std::uint32_t i) {
    taken.add(box_of(layer.mesh(), layer.mesh().trapezoids[i]));
  });
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

LongitudeStrip strip_around_layers(std::span<const std::string> names, const Dataset& dataset) {
  Box all;
  for (const std::string& name : names) {
    all.include(dataset.layers()[*dataset.find(name)].layer->bounds());
  }
  if (all.is_empty()) return {};
  const auto [west, south, east, north] = bounds_in_degrees(all);
  const LongitudeStrip within{west, east};
  if (east - west <= 180) return within;  // no gap is wider than the one around it
  TakenLongitudes taken;
  for (const std::string& name : names) {
    const ServedLayer& served = dataset.layers()[*dataset.find(name)];
    if (served.parts == nullptr) {
      add_trapezoids(*served.layer, taken);
    } else {
      for (const auto& part : served.parts->parts()) taken.add(part->summary().bounds);
    }
  }
  const auto strip = taken.strip();
  return strip && strip->east > 180 ? *strip : within;
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
