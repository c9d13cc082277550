#include "server/tiles/drawing_cost.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/visible_parts.h"
#include "server/tiles/layer_drawing.h"
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

/// How many features over each other can be told from each other, at most; 0 if all that are
/// painted are opaque.
double depth_of(const LayerStyle& style) {
  double depth = 0;
  for (const ClassPaint& paint : style.paints) {
    if (paint.fill.a == 0 || paint.fill.a == 255) continue;
    const double share = 1 - paint.fill.a / 255.0;  // that is seen through one
    depth = std::max(depth, std::log(double{VisibleParts::kLeastShare}) / std::log(share));
  }
  return depth;
}

/// Of that many trapezoids, by those that lie over them. What is seen through others is cut up by
/// all of them, so that its parts grow by the square of how many they are. The features are those
/// of the layer with the test of topology: the one without has no table of them.
std::uint64_t cost_of_cuts(std::uint64_t trapezoids, const TilePlan& plan,
                           const LayerPaint& paint) {
  const OverlapTable& overlaps = plan.layer_of(paint).overlaps();
  const std::size_t pairs =
      (is_plain(paint.style) ? overlaps.pairs_along() : overlaps.pairs().size()) / 2;
  if (pairs == 0) return 0;
  const std::size_t features =
      plan.dataset->layers_on_all_grids()[paint.layer].layer->features().size();
  const std::uint64_t cost = trapezoids + trapezoids * pairs / features;
  const double each = static_cast<double>(pairs) / static_cast<double>(features);
  const double depth = std::min(depth_of(paint.style), each);
  if (depth <= 1) return cost;
  return cost + static_cast<std::uint64_t>(static_cast<double>(trapezoids) * depth * (depth - 1) *
                                           kSidesPerPartSeenThrough);
}

std::uint64_t cost_of_layer(const TilePlan& plan, const LayerPaint& paint, const View& view) {
  const Layer& layer = plan.layer_of(paint);
  const Layer::Selection selection = selection_of(plan, paint, view);
  const std::uint64_t trapezoids = layer.estimate_trapezoids(selection);
  const std::uint64_t grains =
      layer.grains().count_near(selection.box, births_of_dust(paint, selection));
  const std::uint64_t shapes = trapezoids + grains;
  const std::uint64_t masks = std::min<std::uint64_t>(shapes, paint.style.paints.size());
  std::uint64_t cost = trapezoids + shapes + masks * (pixels_of(view) / kPixelsPerSide);
  cost += cost_of_cuts(trapezoids, plan, paint);
  if (view.projection == Projection::plate_carree) cost += shapes * kSidesPerProjectedTrapezoid;
  if (plan.debug.any()) cost += trapezoids * kSidesPerMarkedTrapezoid;
  if (paint.style.stroke.width > 0) {
    const std::uint64_t edges = 2 * trapezoids + layer.estimate_horizontal_edges(selection);
    cost += cost_of_outlines(edges, paint.style.stroke, view, plan.scale);
  }
  return cost;
}

}  // namespace

std::uint64_t drawing_cost(const TilePlan& plan) {
  std::uint64_t cost = pixels_of(plan.view) / kPixelsPerSide;
  for (const View& copy : views_of_copies(plan.view)) {
    for (const LayerPaint& paint : plan.layers) cost += cost_of_layer(plan, paint, copy);
  }
  return cost;
}

}  // namespace trapeze
