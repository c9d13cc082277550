#include "server/tiles/tile_plan.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/data/layer_summary.h"
#include "server/tiles/map_window.h"

namespace trapeze {
namespace {

/// If pixels are not square, the shorter side decides.
Level level_of_layer(const View& view, const StyleQuery& query, const ServedLayer& layer) {
  return nearest_level(tolerance_in_pixels(query, layer) * view.shorter_side());
}

Topology topology_of_layer(const StyleQuery& query, const std::string& layer) {
  const auto value = query.value_for(layer, ParameterId::topology);
  return value ? kTopologyNames.find(std::get<std::string>(*value)).value() : Topology::strict;
}

SmallPolygons small_of_layer(const StyleQuery& query, const std::string& layer, double grow) {
  const auto value = query.value_for(layer, ParameterId::small);
  if (value) return kSmallPolygonsNames.find(std::get<std::string>(*value)).value();
  return grow > 0 ? SmallPolygons::keep : SmallPolygons::dust;
}

DebugMarks debug_marks(const StyleQuery& query) {
  const auto value = query.value_for({}, ParameterId::debug);
  if (!value) return {};
  const auto& words = std::get<std::string>(*value);
  DebugMarks marks;
  for (const std::string_view name : kDebugMarkNames.names()) {
    marks.*kDebugMarkNames.find(name).value() = words.find(name) != std::string::npos;
  }
  return marks;
}

Quality quality_of(const StyleQuery& query) {
  const auto value = query.value_for({}, ParameterId::quality);
  return value ? kQualityNames.find(std::get<std::string>(*value)).value() : Quality::bounded;
}

/// Zooms below 0, at which the whole world is smaller than a tile, count as zoom 0.
bool is_drawn_at(const LayerConfig& config, double zoom) {
  return std::max(zoom, 0.0) >= config.min_zoom && std::floor(zoom) <= config.max_zoom;
}

/// Checks the parts that may be read for the view, with a margin.
bool has_damaged_part(const PreparedParts& parts, const View& view) {
  constexpr double kPixelsAround = 512;
  if (parts.overview() != nullptr && parts.overview()->is_damaged()) return true;
  const auto around = static_cast<std::int64_t>(std::ceil(kPixelsAround * view.longer_side()));
  for (const View& copy : views_of_copies(view)) {
    const Box box = copy.box();
    if (box.is_empty()) continue;
    for (const auto& part : parts.parts()) {
      const Box& bounds = part->summary().bounds;
      const bool is_near = bounds.min_x - around <= box.max_x &&
                           bounds.max_x + around >= box.min_x &&
                           bounds.min_y - around <= box.max_y && bounds.max_y + around >= box.min_y;
      if (is_near && part->is_damaged()) return true;
    }
  }
  return false;
}

Problem no_fast_topology(const std::string& layer) {
  return {400,
          fmt::format("The layer \"{}\" is not served with topology=fast: its configuration does "
                      "not set fast_topology.",
                      layer),
          "topology", "fast", "strict"};
}

}  // namespace

const Layer& TilePlan::layer_of(const LayerPaint& paint) const {
  return *dataset->layers_on_all_grids()[paint.layer].layer_for(paint.topology);
}

const ServedLayer* TilePlan::damaged_layer() const {
  for (const LayerPaint& paint : layers) {
    const ServedLayer& served = dataset->layers_on_all_grids()[paint.layer];
    if (served.parts == nullptr ? !served.is_whole() : has_damaged_part(*served.parts, view)) {
      return &served;
    }
  }
  return nullptr;
}

Level TilePlan::pixel_level() const {
  return nearest_level(view.shorter_side() / 4);
}

std::string TilePlan::key() const {
  std::string key = fmt::format("{},{} {:a}", view.origin_x, view.origin_y, view.cells_per_pixel);
  if (view.projection != Projection::mercator) {
    key += fmt::format(" {} ", static_cast<int>(view.projection));
  }
  if (view.stretch != 1) key += fmt::format("*{:a}", view.stretch);
  key += fmt::format(" {}x{}@{} {}", view.width, view.height, scale, to_hex(background));
  for (const LayerPaint& paint : layers) {
    const ServedLayer& layer = dataset->layers_on_all_grids()[paint.layer];
    key += fmt::format(" {}:{:016x}={}/{}/{} {}", layer.config.name, layer.revision, paint.level,
                       static_cast<int>(paint.topology), static_cast<int>(paint.small),
                       paint.style.key());
  }
  for (const LabelledLayer& layer : labels) {
    const ServedLayer& served = dataset->layers_on_all_grids()[layer.layer];
    // Where labels are placed depends on the exact tolerance, and on layers that are not painted.
    key += fmt::format(" label {:016x} {:d} {} {} {} {}", served.revision, layer.is_drawn,
                       layer.tolerance, layer.min_zoom, layer.style->key(),
                       layer.classing.is_plain() ? "" : layer.classing.key());
  }
  if (format == TileFormat::webp) key += " webp";
  if (quality == Quality::exact) key += " exact";
  if (debug.any())
    key += fmt::format(" debug {:d}{:d}{:d}{:d}{:d}", debug.faces, debug.mesh, debug.vertices,
                       debug.junctions, debug.tile);
  if (debug.tile) key += " " + caption;
  return key;
}

Result<TilePlan> plan_tile(TileRequest request, std::shared_ptr<const Dataset> dataset) {
  return plan_window(window_of(std::move(request)), std::move(dataset));
}

bool has_to_look(const WindowRequest& request, const Dataset& dataset) {
  return std::ranges::any_of(request.layers, [&](const std::string& name) {
    const auto layer = dataset.find(name);
    if (!layer) return false;
    const ServedLayer& served = dataset.layers()[*layer];
    if (!names_values(request.style, name) && !names_values(served.config.style, name))
      return false;
    const auto query = complete_style(request.style, served.config);
    return query && has_to_look(*query, served);
  });
}

Result<TilePlan> plan_window(const WindowRequest& request, std::shared_ptr<const Dataset> dataset) {
  TilePlan plan{std::move(dataset),
                request.view,
                request.scale,
                kTransparent,
                {},
                {},
                debug_marks(request.style),
                request.format,
                quality_of(request.style),
                request.caption};
  if (const auto background = request.style.value_for({}, ParameterId::background)) {
    const Rgba colour = std::get<Rgba>(*background);
    if (colour.a > 0) plan.background = colour;
  }
  const double zoom = request.system->zoom_of(request.view, request.scale);
  for (const std::string& name : request.layers) {
    const auto layer = plan.dataset->find(name);
    if (!layer) return unknown_layer(name, *plan.dataset);
    const auto drawn = plan.dataset->find(name, request.system->grid);
    if (!drawn) return not_built(name, *request.system, *plan.dataset);
    const ServedLayer& served = plan.dataset->layers_on_all_grids()[*drawn];
    const LayerConfig& config = served.config;
    const auto query = complete_style(request.style, config);
    if (!query) return query.problem();
    auto style = layer_style(*query, served, *layer);
    if (!style) return std::move(style).problem();
    const bool is_drawn = is_drawn_at(config, zoom);
    if (style->label != nullptr) {
      plan.labels.push_back({*drawn, style->label, style->classing,
                             tolerance_in_pixels(*query, served),
                             static_cast<double>(config.min_zoom), is_drawn});
    }
    if (!is_drawn) continue;
    if (!style->is_visible() && !plan.debug.any()) continue;
    const Topology topology = topology_of_layer(*query, name);
    if (served.layer_for(topology) == nullptr) return no_fast_topology(name);
    const SmallPolygons small = small_of_layer(*query, name, style->grow);
    plan.layers.push_back(
        {*drawn, *std::move(style), level_of_layer(plan.view, *query, served), topology, small});
  }
  return plan;
}

}  // namespace trapeze
