#include "server/tiles/drawing_cost.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/visible_parts.h"
#include "server/tiles/layer_drawing.h"
#include "server/tiles/layer_pieces.h"
#include "server/tiles/map_window.h"

namespace trapeze {
namespace {

std::uint64_t pixels_of(const View& view) {
  return static_cast<std::uint64_t>(view.width) * static_cast<std::uint64_t>(view.height);
}

std::uint64_t cost_of_outlines(std::uint64_t edges, const Stroke& stroke, const View& view,
                               double scale) {
  const std::uint64_t sides = stroke.is_dashed() ? kSidesPerDashedEdge : kSidesPerOutlineEdge;
  return edges * sides + stroke.most_values(edges, view, scale) / kPixelsPerSide;
}

/// How many overlapping features can be distinguished at most; 0 if all painted features are
/// opaque.
double depth_of(const LayerStyle& style) {
  double depth = 0;
  for (const ClassPaint& paint : style.paints) {
    if (paint.fill.a == 0 || paint.fill.a == 255) continue;
    const double share = 1 - paint.fill.a / 255.0;  // share that shows through one feature
    depth = std::max(depth, std::log(double{VisibleParts::kLeastShare}) / std::log(share));
  }
  return depth;
}

/// Approximate amounts that a layer's selection contains.
struct Amounts {
  std::uint64_t trapezoids = 0;
  std::uint64_t horizontal_edges = 0;
  std::uint64_t grains = 0;
  std::uint64_t pairs = 0;        // of overlapping features, in the whole layer
  std::uint64_t pairs_along = 0;  // those whose boundaries run along each other
  std::uint64_t features = 0;     // in the whole layer
};

/// The cost of cutting that many trapezoids by overlapping ones. A trapezoid that shows through
/// others is cut by all of them, so the number of parts grows with the square of their number. The
/// counts are those of the layer with the topology test; the layer without it has no table of
/// overlaps.
std::uint64_t cost_of_cuts(const Amounts& amounts, const LayerStyle& style, const View& view) {
  const std::uint64_t trapezoids = amounts.trapezoids;
  const bool is_along_only = is_plain(style) && has_fine_pixels(view);
  const std::uint64_t pairs = (is_along_only ? amounts.pairs_along : amounts.pairs) / 2;
  if (pairs == 0) return 0;
  const std::uint64_t features = amounts.features;
  const std::uint64_t cost = trapezoids + trapezoids * pairs / features;
  const double each = static_cast<double>(pairs) / static_cast<double>(features);
  const double depth = std::min(depth_of(style), each);
  if (depth <= 1) return cost;
  return cost + static_cast<std::uint64_t>(static_cast<double>(trapezoids) * depth * (depth - 1) *
                                           kSidesPerPartSeenThrough);
}

Amounts amounts_of(const TilePlan& plan, const LayerPaint& paint, const View& view) {
  const Layer& layer = plan.layer_of(paint);
  const Layer::Selection selection = selection_of(plan, paint, view);
  Amounts amounts;
  amounts.trapezoids = layer.estimate_trapezoids(selection);
  amounts.grains = layer.grains().count_near(selection.box, births_of_dust(paint, selection));
  amounts.pairs = layer.overlaps().pairs().size();
  amounts.pairs_along = layer.overlaps().pairs_along();
  amounts.features = plan.dataset->layers_on_all_grids()[paint.layer].layer->features().size();
  if (paint.style.stroke.width > 0) {
    amounts.horizontal_edges = layer.estimate_horizontal_edges(selection);
  }
  return amounts;
}

/// The share of one box that lies in another one.
double share_of(const Box& box, const Box& within) {
  const auto length = [](std::int32_t min, std::int32_t max) {
    return std::max(0.0, static_cast<double>(max) - min + 1);
  };
  const double all = length(box.min_x, box.max_x) * length(box.min_y, box.max_y);
  const double common =
      length(std::max(box.min_x, within.min_x), std::min(box.max_x, within.max_x)) *
      length(std::max(box.min_y, within.min_y), std::min(box.max_y, within.max_y));
  return all > 0 ? common / all : 0;
}

/// Estimated from the descriptions of the parts, as if their contents were evenly spread: opening
/// the parts would take longer than this function may.
Amounts amounts_of_parts(const TilePlan& plan, const LayerPaint& paint, const View& view) {
  const Layer::Selection selection = selection_of(plan, paint, view);
  const Level resolution = std::min(selection.level, selection.pixel_level);
  const GrainIndex::Births births = births_of_dust(paint, selection);
  Amounts amounts;
  for (const PreparedPart* part : parts_in_view(plan, paint, view)) {
    const PreparedSummary& summary = part->summary();
    const LevelCounts& counts = summary.counts;
    std::uint64_t trapezoids = counts.trapezoids[selection.level];
    if (selection.small == SmallPolygons::dust) trapezoids += counts.motes[resolution];
    std::uint64_t grains = 0;
    for (std::size_t level = births.first; level <= births.last; ++level) {
      grains += counts.grains[level];
    }
    const double share = share_of(summary.bounds, selection.box);
    const auto shared = [share](std::uint64_t count) {
      return static_cast<std::uint64_t>(std::ceil(static_cast<double>(count) * share));
    };
    amounts.trapezoids += shared(trapezoids);
    amounts.horizontal_edges += shared(counts.horizontal_edges[selection.level]);
    amounts.grains += shared(grains);
    amounts.pairs += counts.overlaps;
    amounts.pairs_along += counts.overlaps_along;
    amounts.features += std::max<std::uint64_t>(summary.report.loaded, 1);
  }
  return amounts;
}

std::uint64_t cost_of_layer(const TilePlan& plan, const LayerPaint& paint, const View& view) {
  const bool is_in_parts = plan.dataset->layers_on_all_grids()[paint.layer].parts != nullptr;
  const Amounts amounts =
      is_in_parts ? amounts_of_parts(plan, paint, view) : amounts_of(plan, paint, view);
  const std::uint64_t trapezoids = amounts.trapezoids;
  const std::uint64_t shapes = trapezoids + amounts.grains;
  const std::uint64_t masks = std::min<std::uint64_t>(shapes, paint.style.paints.size());
  std::uint64_t cost = trapezoids + shapes + masks * (pixels_of(view) / kPixelsPerSide);
  cost += cost_of_cuts(amounts, paint.style, view);
  if (view.projection == Projection::plate_carree) cost += shapes * kSidesPerProjectedTrapezoid;
  if (paint.style.smooth > 0) cost += trapezoids * kSidesPerRoundedTrapezoid;
  if (paint.style.grow > 0) {
    const auto pixels = static_cast<std::uint64_t>(std::ceil(paint.style.grow * plan.scale));
    cost += trapezoids * (kSidesPerGrownTrapezoid + pixels * kSidesPerGrownPixel);
  }
  if (plan.debug.any()) cost += trapezoids * kSidesPerMarkedTrapezoid;
  if (paint.style.stroke.width > 0) {
    const std::uint64_t edges = 2 * trapezoids + amounts.horizontal_edges;
    cost += cost_of_outlines(edges, paint.style.stroke, view, plan.scale);
  }
  return cost;
}

}  // namespace

std::uint64_t drawing_cost(const TilePlan& plan) {
  std::uint64_t cost = pixels_of(plan.view) / kPixelsPerSide;
  if (plan.debug.any()) cost += pixels_of(plan.view) * kSidesPerMarkedPixel;
  for (const LayerPaint& paint : plan.layers) {
    for (const View& copy : views_of_copies(plan.view, reach_of_lines(plan, paint))) {
      cost += cost_of_layer(plan, paint, copy);
    }
  }
  return cost;
}

std::uint64_t encoding_cost(const TilePlan& plan) {
  return plan.format == TileFormat::webp ? pixels_of(plan.view) * kSidesPerWebpPixel : 0;
}

}  // namespace trapeze
