#include "server/tile_plan.h"

#include <spdlog/fmt/fmt.h>

#include <array>

#include "render/coverage.h"
#include "server/build_id.h"
#include "server/content_hash.h"

namespace trapeze {
namespace {

// Default tolerance, in output pixels: too small to be seen.
constexpr double kTolerancePixels = 0.25;

// Colours of layers that were given none: muted, told apart, readable over each other.
constexpr std::array<Rgba, 8> kPalette = {{{0x7f, 0xa6, 0x87, 255},
                                           {0x6f, 0xa8, 0xc9, 255},
                                           {0xd9, 0x9b, 0x6c, 255},
                                           {0x9d, 0x87, 0xb8, 255},
                                           {0xd7, 0xb9, 0x5b, 255},
                                           {0xc6, 0x7b, 0x82, 255},
                                           {0x62, 0xa6, 0xa0, 255},
                                           {0x94, 0x8b, 0x80, 255}}};

Rgba fill_of_layer(const StyleQuery& query, const LayerConfig& config, std::size_t layer) {
  Rgba fill = default_fill(config, layer);
  if (const auto value = query.value_for(config.name, ParameterId::fill)) {
    fill = std::get<Rgba>(*value);
  }
  double opacity = config.style.fill_opacity;
  if (const auto value = query.value_for(config.name, ParameterId::fill_opacity)) {
    opacity = std::get<double>(*value);
  }
  return with_opacity(fill, opacity);
}

double cells_per_pixel(const TileId& tile, int scale) {
  return static_cast<double>(tile.side()) / (static_cast<double>(kTilePixels) * scale);
}

Level level_of_layer(const TileRequest& request, const std::string& layer) {
  double pixels = kTolerancePixels;
  if (const auto value = request.style.value_for(layer, ParameterId::simplify)) {
    pixels = std::get<double>(*value);
  }
  return nearest_level(pixels * cells_per_pixel(request.tile, request.scale));
}

Topology topology_of_layer(const StyleQuery& query, const std::string& layer) {
  const auto value = query.value_for(layer, ParameterId::topology);
  return value && std::get<std::string>(*value) == "fast" ? Topology::fast : Topology::strict;
}

SmallPolygons small_of_layer(const StyleQuery& query, const std::string& layer) {
  const auto value = query.value_for(layer, ParameterId::small);
  if (!value || std::get<std::string>(*value) == "dust") return SmallPolygons::dust;
  return std::get<std::string>(*value) == "keep" ? SmallPolygons::keep : SmallPolygons::drop;
}

DebugMarks debug_marks(const StyleQuery& query) {
  const auto value = query.value_for({}, ParameterId::debug);
  if (!value) return {};
  const std::string& words = std::get<std::string>(*value);
  const auto has = [&words](std::string_view word) {
    return words.find(word) != std::string::npos;
  };
  return {has("mesh"), has("vertices"), has("tile")};
}

}  // namespace

Level TilePlan::pixel_level() const {
  return nearest_level(cells_per_pixel(tile, scale) / 4);
}

std::string TilePlan::key() const {
  std::string key =
      fmt::format("{}/{}/{}@{} {}", tile.z, tile.x, tile.y, scale, to_hex(background));
  for (const LayerPaint& paint : layers) {
    const ServedLayer& layer = dataset->layers()[paint.layer];
    key += fmt::format(" {}:{:016x}={}/{}/{}/{}", layer.config.name, layer.revision,
                       to_hex(paint.fill), paint.level, static_cast<int>(paint.topology),
                       static_cast<int>(paint.small));
  }
  if (debug.any())
    key += fmt::format(" debug {:d}{:d}{:d}", debug.mesh, debug.vertices, debug.tile);
  return key;
}

std::string entity_tag_of(std::string_view key) {
  ContentHash hash;
  hash.add(build_id());
  hash.add(key);
  return fmt::format("\"{:016x}\"", hash.value());
}

Rgba default_fill(const LayerConfig& config, std::size_t position) {
  return config.style.fill.value_or(kPalette[position % kPalette.size()]);
}

OrProblem<TilePlan> plan_tile(const TileRequest& request, std::shared_ptr<const Dataset> dataset) {
  TilePlan plan{dataset, request.tile, request.scale, kTransparent, {}, debug_marks(request.style)};
  if (const auto background = request.style.value_for({}, ParameterId::background)) {
    const Rgba colour = std::get<Rgba>(*background);
    if (colour.a > 0) plan.background = colour;
  }
  for (const std::string& name : request.layers) {
    const auto layer = dataset->find(name);
    if (!layer) return unknown_layer(name, *dataset);
    const LayerConfig& config = dataset->layers()[*layer].config;
    if (request.tile.z < config.min_zoom || request.tile.z > config.max_zoom) continue;
    const Rgba fill = fill_of_layer(request.style, config, *layer);
    if (fill.a == 0 && !plan.debug.any()) continue;
    plan.layers.push_back({*layer, fill, level_of_layer(request, name),
                           topology_of_layer(request.style, name),
                           small_of_layer(request.style, name)});
  }
  return plan;
}

Problem unknown_layer(const std::string& name, const Dataset& dataset) {
  constexpr std::size_t kMaxNames = 20;
  std::string names;
  for (std::size_t i = 0; i < dataset.layers().size() && i < kMaxNames; ++i) {
    names += (i == 0 ? "" : ", ") + dataset.layers()[i].config.name;
  }
  if (dataset.layers().size() > kMaxNames) names += ", ... (all are in /catalog)";
  return {404, fmt::format("There is no layer \"{}\".", name), "layers", name, "one of " + names};
}

}  // namespace trapeze
