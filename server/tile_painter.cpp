#include "server/tile_painter.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "render/debug_marks.h"
#include "render/png.h"

namespace trapeze {
namespace {

/// Adds to `sum_ms` the time from its making to its end.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum_ms) : sum_ms_(sum_ms), begin_(TilePainter::Clock::now()) {}
  ~Stopwatch() {
    const auto duration = TilePainter::Clock::now() - begin_;
    sum_ms_ += std::chrono::duration<double, std::milli>(duration).count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& sum_ms_;
  const TilePainter::Clock::time_point begin_;
};

constexpr Rgba kMeshColour{0x20, 0x30, 0x48, 150};
constexpr Rgba kVertexColour{0xc0, 0x20, 0x20, 255};
constexpr Rgba kBorderColour{0x70, 0x20, 0x90, 255};

const Layer& painted_layer(const TilePlan& plan, const LayerPaint& paint) {
  const Layer& layer = *plan.dataset->layers()[paint.layer].layer;
  return paint.topology == Topology::fast ? layer.without_topology_test() : layer;
}

/// At least `side` cells wide and high, around the same middle.
Box widened(const Box& box, std::int64_t side) {
  const auto widen = [side](std::int32_t& min, std::int32_t& max) {
    const std::int64_t missing = side - (std::int64_t{max} - min);
    if (missing <= 0) return;
    const std::int64_t from =
        std::clamp<std::int64_t>(min - missing / 2, kGridMin, kGridMax - side);
    min = static_cast<std::int32_t>(from);
    max = static_cast<std::int32_t>(from + side);
  };
  Box wide = box;
  widen(wide.min_x, wide.max_x);
  widen(wide.min_y, wide.max_y);
  return wide;
}

}  // namespace

TilePainter::TilePainter(std::unique_ptr<CoverageRenderer> renderer)
    : renderer_(std::move(renderer)) {}

std::optional<PaintedTile> TilePainter::paint(const TilePlan& plan, Deadline deadline) {
  PaintedTile tile;
  const View view = View::of_tile(plan.tile, plan.scale);
  const Box box = view.box();
  if (coverages_.size() < plan.layers.size()) coverages_.resize(plan.layers.size());
  std::vector<FilledLayer> filled;
  for (const LayerPaint& paint : plan.layers) {
    if (Clock::now() > deadline) return std::nullopt;
    if (paint.fill.a == 0) continue;  // here for its marks only
    const Layer& layer = painted_layer(plan, paint);
    {
      const Stopwatch stopwatch(tile.times.select_ms);
      const Layer::Selection selection{box, paint.level, plan.pixel_level(), paint.small};
      layer.select(selection, ranges_);
      places_.clear();
      if (paint.small == SmallPolygons::keep) layer.small_polygons(selection, places_);
    }
    if (ranges_.empty() && places_.empty()) continue;  // there is nothing of this layer here
    const Stopwatch stopwatch(tile.times.draw_ms);
    Coverage& coverage = coverages_[filled.size()];
    if (places_.empty()) {
      renderer_->draw(layer.mesh(), ranges_, view, coverage);
    } else {
      draw_with_places(layer, view, coverage);
    }
    filled.push_back({&coverage, paint.fill});
  }
  {
    const Stopwatch stopwatch(tile.times.compose_ms);
    composer_.compose(filled, view.width, view.height, plan.background, picture_);
    if (plan.debug.any()) mark(plan, view, picture_);
  }
  {
    const Stopwatch stopwatch(tile.times.encode_ms);
    tile.png = encoder_.encode(picture_);
  }
  return tile;
}

/// Draws the ranges, and the places of small polygons widened to whole pixels. Their mesh is new
/// for every picture; there are no more of them than pixels.
void TilePainter::draw_with_places(const Layer& layer, const View& view, Coverage& out) {
  std::vector<Point> vertices;
  std::vector<MeshEdge> edges;
  std::vector<MeshTrapezoid> trapezoids;
  const auto pixel = static_cast<std::int64_t>(std::ceil(view.cells_per_pixel));
  for (const Box& place : places_) {
    append_box(widened(place, pixel), vertices, edges, trapezoids);
  }
  const MeshView mesh{new_mesh_id(), vertices, edges, trapezoids};
  const TrapezoidRange all{0, static_cast<std::uint32_t>(trapezoids.size())};
  const std::array<MeshPart, 2> parts{MeshPart{layer.mesh(), ranges_}, MeshPart{mesh, {&all, 1}}};
  renderer_->draw(parts, view, out);
  renderer_->forget(mesh.id);
}

void TilePainter::mark(const TilePlan& plan, const View& view, Picture& picture) {
  spread_palette(picture);
  for (const LayerPaint& paint : plan.layers) {
    const Layer& layer = painted_layer(plan, paint);
    layer.select({view.box(), paint.level, plan.pixel_level(), SmallPolygons::drop}, ranges_);
    if (plan.debug.mesh) mark_mesh(layer.mesh(), ranges_, view, kMeshColour, picture);
    if (plan.debug.vertices) mark_vertices(layer.mesh(), ranges_, view, kVertexColour, picture);
  }
  if (!plan.debug.tile) return;
  std::string text = fmt::format("{}/{}/{}", plan.tile.z, plan.tile.x, plan.tile.y);
  if (plan.scale > 1) text += fmt::format(" {}x", plan.scale);
  mark_border(text, kBorderColour, picture);
}

}  // namespace trapeze
