#include "server/seed/known_tiles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/grid/ring_box.h"
#include "core/mesh/mesh_index.h"
#include "render/mask/mask.h"
#include "server/seed/hilbert_order.h"
#include "server/tiles/layer_drawing.h"

namespace trapeze {
namespace {

/// With so many trapezoids below it, a tile is hardly ever of one colour.
constexpr std::uint64_t kMostTrapezoids = 4096;

/// How far away dust is collected, and how far enlarged small polygons reach, in pixels.
constexpr double kReachOfDust = 3;

/// Places are rounded to cells, here and when a tile is drawn.
constexpr double kCellsForRounding = 2;

Box widened(const TileId& tile, double cells) {
  const auto margin = static_cast<std::int64_t>(std::ceil(cells + kCellsForRounding));
  const auto cell = [](std::int64_t v) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, kGridMin, kGridMax));
  };
  return {cell(tile.origin_x() - margin), cell(tile.origin_y() - margin),
          cell(tile.origin_x() + tile.side() + margin),
          cell(tile.origin_y() + tile.side() + margin)};
}

/// The length of the boundary between two heights, measured by the columns and rows of tiles it
/// crosses.
double crossing_length(const MeshView& mesh, const MeshTrapezoid& trapezoid, const Box& box) {
  const double top = std::max(mesh.vertices[trapezoid.top].y, box.min_y);
  const double bottom = std::min(mesh.vertices[trapezoid.bottom].y, box.max_y);
  if (top >= bottom) return 0;
  double length = 0;
  for (const std::uint32_t edge : {trapezoid.left, trapezoid.right}) {
    const EdgeLine line(mesh, edge);
    const auto clamped = [&](double y) {
      return std::clamp<double>(line.x_at(y), box.min_x, box.max_x);
    };
    const double from = clamped(top);
    const double to = clamped(bottom);
    const bool is_outside = from == to && (from == box.min_x || from == box.max_x);
    if (!is_outside) length += bottom - top + std::abs(to - from);
  }
  return length;
}

/// The area within the box, exact for trapezoids whose sides do not cross those of the box.
double covered_area(const MeshView& mesh, const MeshTrapezoid& trapezoid, const Box& box) {
  const double top = std::max(mesh.vertices[trapezoid.top].y, box.min_y);
  const double bottom = std::min(mesh.vertices[trapezoid.bottom].y, box.max_y);
  if (top >= bottom) return 0;
  const EdgeLine left(mesh, trapezoid.left);
  const EdgeLine right(mesh, trapezoid.right);
  const auto width = [&](double y) {
    return std::clamp<double>(right.x_at(y), box.min_x, box.max_x) -
           std::clamp<double>(left.x_at(y), box.min_x, box.max_x);
  };
  return (bottom - top) * (width(top) + width(bottom)) / 2;
}

/// Whether anything other than polygons is drawn with that zoom's selection.
bool has_dust_or_edges(const Layer& layer, const LevelSpan& span, const Layer::Selection& selection,
                       const LayerPaint& paint) {
  const std::span<const Lifespan> lifespans = layer.lifespans();
  const auto is_any_alive = [&](std::span<const std::uint32_t> trapezoids, Level level) {
    return std::ranges::any_of(trapezoids,
                               [&](std::uint32_t i) { return lifespans[i].contains(level); });
  };
  const GrainIndex::Births births = births_of_dust(paint, selection);
  return is_any_alive(span.motes(), std::min(selection.level, selection.pixel_level)) ||
         is_any_alive(span.edges(), selection.level) ||
         std::ranges::any_of(span.grains(), [&](const FeatureGrain* grain) {
           return births.contains(grain->born);
         });
}

/// A layer at the first zoom at which it is drawn.
struct FirstDrawn {
  const TilePlan* plan = nullptr;
  const LayerPaint* paint = nullptr;

  std::size_t layer() const { return paint->layer; }
};

/// The layers that are drawn at any of the zooms, from the top. A layer that begins later goes
/// below the one that it lies under at its first zoom. Each is drawn at consecutive zooms, so one
/// that has ended by then is never drawn together with it.
std::vector<FirstDrawn> layers_from_the_top(const SeedPlan& plan) {
  std::vector<FirstDrawn> layers;
  for (int zoom = plan.zooms().first; zoom <= plan.zooms().last; ++zoom) {
    const TilePlan& of_zoom = plan.at(zoom);
    auto below = layers.begin();  // where a layer under the previous one goes
    for (auto paint = of_zoom.layers.rbegin(); paint != of_zoom.layers.rend(); ++paint) {
      if (!paint->style.is_visible()) continue;
      auto found = std::ranges::find(layers, paint->layer, &FirstDrawn::layer);
      if (found == layers.end()) found = layers.insert(below, {&of_zoom, &*paint});
      below = found + 1;
    }
  }
  return layers;
}

}  // namespace

KnownTiles::KnownTiles(const SeedPlan& plan, std::shared_ptr<FeatureClassCache> classes,
                       std::shared_ptr<LabelBook> labels)
    : plan_(plan), classes_(std::move(classes)), labels_(std::move(labels)) {
  const ZoomRange zooms = plan.zooms();
  steps_.resize(static_cast<std::size_t>(zooms.last) + 1);
  looks_.resize(steps_.size());
  for (const FirstDrawn& first : layers_from_the_top(plan)) add_drawn(*first.plan, *first.paint);
  for (int zoom = zooms.first; zoom <= zooms.last; ++zoom) {
    for (const LayerPaint& paint : plan.at(zoom).layers) {
      for (Drawn& drawn : drawn_) {
        if (drawn.layer == paint.layer) drawn.paints[static_cast<std::size_t>(zoom)] = &paint;
      }
    }
  }
  for (Step& step : steps_) {
    step.spans.resize(drawn_.size());
    step.is_found.resize(drawn_.size());
  }
}

/// Adds the layer, or each of its parts.
void KnownTiles::add_drawn(const TilePlan& plan, const LayerPaint& paint) {
  const ServedLayer& served = plan.dataset->layers_on_all_grids()[paint.layer];
  Drawn drawn;
  drawn.layer = paint.layer;
  drawn.number = drawn_.empty() ? 0 : drawn_.back().number + 1;
  drawn.topology = paint.topology;
  drawn.paints.resize(steps_.size());
  if (served.parts == nullptr) {
    drawn.opened = served.layer_for(paint.topology);
    const Classing& classing = paint.style.classing;
    if (!classing.is_plain()) {
      drawn.classes = classes_->find(served.revision, classing, served.layer->features());
    }
    drawn_.push_back(std::move(drawn));
    return;
  }
  for (const auto& part : served.parts->parts()) {
    drawn.part = part.get();
    drawn_.push_back(drawn);
  }
}

/// False if a part cannot be opened: drawing it will report the error.
bool KnownTiles::open(Drawn& drawn, const LayerPaint& paint) {
  if (drawn.opened != nullptr) return true;
  const Layer* layer = drawn.part->layer().get();  // kept alive by the part
  if (layer == nullptr) return false;
  const Classing& classing = paint.style.classing;
  if (!classing.is_plain()) {
    drawn.classes = classes_->find(drawn.part->summary().revision, classing.over(layer->features()),
                                   layer->features());
  }
  drawn.opened = layer;
  return true;
}

int KnownTiles::first_zoom(const TileId& tile) const {
  return std::max(tile.z, plan_.zooms().first);
}

// Covers what any of the zooms selects. Pixels are largest at the first zoom.
LevelSpanSelection KnownTiles::selection_of(const Drawn& drawn, const TileId& tile) const {
  LevelSpanSelection selection;
  double reach = 0;
  double reach_of_dust = 0;
  bool is_first = true;
  for (int zoom = first_zoom(tile); zoom <= plan_.zooms().last; ++zoom) {
    const LayerPaint* paint = drawn.paints[static_cast<std::size_t>(zoom)];
    if (paint == nullptr) continue;
    const TilePlan& plan = plan_.at(zoom);
    const View& view = plan.view;
    const Layer::Selection of_zoom = trapeze::selection_of(plan, *paint, view);
    const Stroke& stroke = paint->style.stroke;
    const double around = paint->style.reach(plan.scale) * view.cells_per_pixel;
    reach = std::max(reach, around);
    reach_of_dust = std::max(reach_of_dust, around + kReachOfDust * view.cells_per_pixel);
    const Level resolution = std::min(of_zoom.level, of_zoom.pixel_level);
    const GrainIndex::Births births = births_of_dust(*paint, of_zoom);
    selection.has_edges = stroke.width > 0;
    selection.has_motes = of_zoom.small != SmallPolygons::drop;
    if (is_first) {
      selection.levels = {of_zoom.level, of_zoom.level};
      selection.resolutions = {resolution, resolution};
      selection.births = births;
      is_first = false;
      continue;
    }
    const auto include = [](LevelRange& range, Level level) {
      range = {std::min(range.finest, level), std::max(range.coarsest, level)};
    };
    include(selection.levels, of_zoom.level);
    include(selection.resolutions, resolution);
    if (births.is_empty()) continue;
    selection.births = selection.births.is_empty()
                           ? births
                           : GrainIndex::Births{std::min(selection.births.first, births.first),
                                                std::max(selection.births.last, births.last)};
  }
  selection.box = widened(tile, reach);
  selection.dust_box = widened(tile, reach_of_dust);
  return selection;
}

void KnownTiles::look_at(const TileId& tile) {
  Step& step = steps_[static_cast<std::size_t>(tile.z)];
  step.tile = tile;
  for (std::size_t k = 0; k < drawn_.size(); ++k) {
    Drawn& drawn = drawn_[k];
    const Step* above = tile.z > 0 ? &steps_[static_cast<std::size_t>(tile.z) - 1] : nullptr;
    const bool is_known_above = above != nullptr && above->is_found[k] != 0;
    if (is_known_above && above->spans[k].empty()) {
      step.spans[k] = LevelSpan();
      step.is_found[k] = 1;
      continue;
    }
    const LevelSpanSelection selection = selection_of(drawn, tile);
    if (is_known_above) {
      step.spans[k].narrow(*drawn.opened, above->spans[k], selection);
      step.is_found[k] = 1;
    } else {
      step.is_found[k] = find(drawn, selection, tile, step.spans[k]) ? 1 : 0;
    }
  }
  find_looks(step);
}

/// Opens a part only if something of it may be there, and not too much.
bool KnownTiles::find(Drawn& drawn, const LevelSpanSelection& selection, const TileId& tile,
                      LevelSpan& span) {
  if (drawn.part != nullptr) {
    const PreparedSummary& summary = drawn.part->summary();
    const Box& bounds = summary.bounds;
    if (!bounds.intersects(selection.box) && !bounds.intersects(selection.dust_box)) {
      span = LevelSpan();
      return true;
    }
    const Box& box = selection.box;
    const bool is_within = box.min_x <= bounds.min_x && box.min_y <= bounds.min_y &&
                           box.max_x >= bounds.max_x && box.max_y >= bounds.max_y;
    if (is_within && summary.counts.trapezoids[selection.levels.finest] > kMostTrapezoids) {
      return false;
    }
  }
  const LayerPaint* paint = nullptr;
  for (int zoom = first_zoom(tile); zoom <= plan_.zooms().last && paint == nullptr; ++zoom) {
    paint = drawn.paints[static_cast<std::size_t>(zoom)];
  }
  if (paint == nullptr) {  // not drawn at any zoom from here on
    span = LevelSpan();
    return true;
  }
  if (!open(drawn, *paint)) return false;
  const std::span<const std::uint8_t> classes =
      drawn.classes == nullptr ? std::span<const std::uint8_t>() : *drawn.classes;
  return span.find(*drawn.opened, classes, selection, kMostTrapezoids);
}

// At any zoom from the tile's own on.
bool KnownTiles::may_have_labels(const TileId& tile) const {
  const TilePlan& plan = plan_.at(first_zoom(tile));
  return !plan.labels.empty() &&
         labels_->is_any_from({*plan.dataset, plan.labels, View::of_tile(tile), 1});
}

// Outlines near the other end of the world reach across the antimeridian. What is looked for there
// has the height of the widened tile, and the width by which the tile is widened.
bool KnownTiles::may_have_lines_over_the_antimeridian(const TileId& tile) {
  const bool is_first = tile.x == 0;
  const bool is_last = tile.x + 1 == std::uint32_t{1} << tile.z;
  if (!is_first && !is_last) return false;
  return std::ranges::any_of(drawn_, [&](Drawn& drawn) {
    LevelSpanSelection selection = selection_of(drawn, tile);
    if (!selection.has_edges) return false;
    if (is_first && is_last) return true;
    Box& box = selection.box;
    if (is_first) {
      const std::int64_t reach = box.max_x - (tile.origin_x() + tile.side());
      box.min_x = static_cast<std::int32_t>(kGridMax - reach);
      box.max_x = kGridMax;
    } else {
      const std::int64_t reach = tile.origin_x() - box.min_x;
      box.min_x = kGridMin;
      box.max_x = static_cast<std::int32_t>(kGridMin + reach);
    }
    selection.dust_box = box;
    return !find(drawn, selection, tile, across_) || !across_.empty();
  });
}

void KnownTiles::find_looks(const Step& step) {
  tile_ = step.tile;
  is_known_ = false;
  std::ranges::fill(looks_, std::nullopt);
  if (may_have_labels(tile_) || may_have_lines_over_the_antimeridian(tile_)) return;
  for (int zoom = first_zoom(tile_); zoom <= plan_.zooms().last; ++zoom) {
    std::optional<TileLook>& look = looks_[static_cast<std::size_t>(zoom)];
    look = find_look(step, zoom);
    if (!look) return;
  }
  is_known_ = true;
}

std::optional<TileLook> KnownTiles::find_look(const Step& step, int zoom) {
  if (plan_.at(zoom).debug.any()) return std::nullopt;
  TileLook look;
  for (std::size_t k = 0; k < drawn_.size(); ++k) {
    const LayerPaint* paint = drawn_[k].paints[static_cast<std::size_t>(zoom)];
    if (paint == nullptr) continue;
    if (step.is_found[k] == 0) return std::nullopt;
    std::uint8_t number = 0;
    const Seen seen = find_seen(drawn_[k], step.spans[k], step.tile, zoom, number);
    if (seen == Seen::something) return std::nullopt;
    if (seen == Seen::nothing) continue;
    look.push_back(static_cast<char>(drawn_[k].number));
    look.push_back(static_cast<char>(number));
    // Nothing below it is visible.
    if (paint->style.paints[number].fill.a == 255 && paint->style.opacity == 1) break;
  }
  return look;
}

KnownTiles::Seen KnownTiles::find_seen(const Drawn& drawn, const LevelSpan& span,
                                       const TileId& tile, int zoom, std::uint8_t& number) {
  if (span.empty()) return Seen::nothing;
  const LayerPaint& paint = *drawn.paints[static_cast<std::size_t>(zoom)];
  const TilePlan& plan = plan_.at(zoom);
  const Layer& layer = *drawn.opened;
  const View& view = plan.view;
  if (has_dust_or_edges(layer, span, trapeze::selection_of(plan, paint, view), paint)) {
    return Seen::something;
  }
  if (!find_alike(drawn, span, layer, paint, number)) return Seen::something;
  if (ranges_.empty()) return Seen::nothing;
  const bool is_filled = paint.style.paints[number].fill.a > 0;
  const bool has_lines = paint.style.stroke.width > 0;
  if (paint.style.pattern.kind != PatternKind::none) return Seen::something;
  if (!is_filled && !has_lines) return Seen::nothing;
  const double reach = paint.style.reach(plan.scale) * view.cells_per_pixel;
  if (!cover_box(layer.mesh(), ranges_, widened(tile, reach))) return Seen::something;
  return is_filled ? Seen::one_colour : Seen::nothing;
}

// Polygons that share edges or overlap must not be combined: an outline may run between them, and
// colours may add up. In that case a single polygon is required.
bool KnownTiles::find_alike(const Drawn& drawn, const LevelSpan& span, const Layer& layer,
                            const LayerPaint& paint, std::uint8_t& number) {
  const bool is_one_needed = paint.style.stroke.width > 0 || !layer.overlaps().empty();
  ranges_.clear();
  std::uint32_t first_row = Layer::kNoFeature;
  for (const std::uint32_t i : span.polygons()) {
    if (!layer.lifespans()[i].contains(paint.level)) continue;
    const std::uint32_t row = layer.feature_of(i);
    const std::uint8_t its = drawn.classes == nullptr ? std::uint8_t{0} : (*drawn.classes)[row];
    if (ranges_.empty()) {
      first_row = row;
      number = its;
    }
    if (its != number || (is_one_needed && row != first_row)) return false;
    append_trapezoid(i, ranges_);
  }
  return true;
}

// Boundaries are not all that keeps tiles from being known: patterns and overlaps do so
// wherever they are, and a feature smaller than a tile does so in a whole tile.
std::optional<KnownTiles::Estimate> KnownTiles::estimate() const {
  const Step& step = steps_[static_cast<std::size_t>(tile_.z)];
  Estimate sum;
  for (int zoom = first_zoom(tile_); zoom <= plan_.zooms().last; ++zoom) {
    const auto side = static_cast<double>(TileId{zoom, 0, 0}.side());
    const TilePlan& plan = plan_.at(zoom);
    const bool is_something = !look_at_zoom(zoom).has_value();
    const auto most = static_cast<double>(places_below(tile_, zoom).count);
    double tiles = plan.debug.any() ? most : 0;
    for (std::size_t k = 0; k < drawn_.size(); ++k) {
      const LayerPaint* paint = drawn_[k].paints[static_cast<std::size_t>(zoom)];
      if (paint == nullptr) continue;
      if (step.is_found[k] == 0) return std::nullopt;
      if (step.spans[k].empty()) continue;
      const Layer& layer = *drawn_[k].opened;
      const std::span<const Lifespan> lifespans = layer.lifespans();
      const Box box = widened(tile_, 0);
      double length = 0;
      double area = 0;
      double features = 0;
      std::uint32_t last_row = Layer::kNoFeature;
      for (const std::uint32_t i : step.spans[k].polygons()) {
        if (!lifespans[i].contains(paint->level)) continue;
        const MeshTrapezoid& trapezoid = layer.mesh().trapezoids[i];
        length += crossing_length(layer.mesh(), trapezoid, box);
        area += covered_area(layer.mesh(), trapezoid, box);
        const std::uint32_t row = layer.feature_of(i);
        if (row != last_row) ++features;
        last_row = row;
        ++sum.trapezoids;
      }
      tiles += length / side;
      if (!is_something) continue;
      const GrainIndex::Births births =
          births_of_dust(*paint, trapeze::selection_of(plan, *paint, plan.view));
      tiles += features + static_cast<double>(std::ranges::count_if(
                              step.spans[k].grains(), [&](const FeatureGrain* grain) {
                                return births.contains(grain->born);
                              }));
      if (paint->style.pattern.kind != PatternKind::none) {
        tiles += area / (side * side);
      } else if (!layer.overlaps().empty()) {
        tiles += std::max(area - area_of(box), 0.0) / (side * side);
      }
    }
    sum.tiles += std::min(tiles + (is_something ? 1 : 0), most);
  }
  return sum;
}

}  // namespace trapeze
