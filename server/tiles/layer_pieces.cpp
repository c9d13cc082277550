#include "server/tiles/layer_pieces.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "server/tiles/layer_drawing.h"

namespace trapeze {
namespace {

/// How far dust and enlarged small polygons reach beyond their places, in pixels.
constexpr double kReachOfDust = 4;

Box widened(const Box& box, double by) {
  if (box.is_empty()) return box;
  const auto cells = static_cast<std::int64_t>(std::ceil(by));
  const auto cell = [](std::int64_t v) {
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(v, kGridMin, kGridMax));
  };
  return {cell(box.min_x - cells), cell(box.min_y - cells), cell(box.max_x + cells),
          cell(box.max_y + cells)};
}

}  // namespace

std::vector<const PreparedPart*> parts_in_view(const TilePlan& plan, const LayerPaint& paint,
                                               const View& view) {
  const PreparedParts& parts = *plan.dataset->layers_on_all_grids()[paint.layer].parts;
  const Layer::Selection selection = selection_of(plan, paint, view);
  const PreparedPart* overview = parts.overview().get();
  if (overview != nullptr && paint.style.classing.is_plain() &&
      std::min(selection.level, selection.pixel_level) >= overview->number().first_level) {
    return {overview};
  }
  const Box box = widened(selection.box, kReachOfDust * view.longer_side() + 2);
  std::vector<const PreparedPart*> seen;
  for (const auto& part : parts.parts()) {
    if (part->summary().bounds.intersects(box)) seen.push_back(part.get());
  }
  return seen;
}

std::vector<LayerPiece> pieces_in_view(const TilePlan& plan, const LayerPaint& paint,
                                       const View& view) {
  const ServedLayer& served = plan.dataset->layers_on_all_grids()[paint.layer];
  if (served.parts == nullptr) return {{&plan.layer_of(paint), served.revision}};
  std::vector<LayerPiece> pieces;
  for (const PreparedPart* part : parts_in_view(plan, paint, view)) {
    const Layer* layer = part->layer().get();  // kept alive by the part
    if (layer == nullptr) throw std::runtime_error(part->problem());
    pieces.push_back({layer, part->summary().revision});
  }
  return pieces;
}

}  // namespace trapeze
